use crate::scalar::Scalar;

/// A value with its derivatives along `T` directions: x and ẋ₁ … ẋ_T.
///
/// `T` = 0 is a plain value, `T` = 1 carries one directional derivative, `T` = N a whole gradient or row of a Hessian.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jet<S, const T: usize> {
    /// Value x.
    pub value: S,
    /// Derivatives ẋ_k along directions k.
    pub tangent: [S; T],
}

impl<S: Scalar, const T: usize> Jet<S, T> {
    /// The constant 0.
    #[inline(always)]
    pub fn zero() -> Self {
        Self { value: S::zero(), tangent: [S::zero(); T] }
    }

    /// f(x) and its tangents f′ẋ, from the two numbers f(x) and f′(x).
    #[inline(always)]
    pub fn chain(&self, value: S, slope: S) -> Self {
        Self { value, tangent: self.tangent.map(|x| slope * x) }
    }

    /// The product rule: xy and ẋ_k y + x ẏ_k for every tangent of `self`; `other` has at least as many.
    #[inline(always)]
    pub fn times<const U: usize>(&self, other: &Jet<S, U>) -> Self {
        let mut product = Self { value: self.value * other.value, tangent: [S::zero(); T] };
        for ((p, x), y) in product.tangent.iter_mut().zip(&self.tangent).zip(&other.tangent) {
            *p = *x * other.value + self.value * *y;
        }
        product
    }

    /// A constant: all tangents zero.
    #[inline(always)]
    pub fn constant(value: S) -> Self {
        Self { value, tangent: [S::zero(); T] }
    }

    /// The parameter t of a curve: its first derivative along the curve is 1, all higher ones are 0.
    #[inline(always)]
    pub fn parameter(t: S) -> Self {
        Self::series(t, [S::one()])
    }

    /// f(t) along a curve, with as many derivatives as the jet carries; missing derivatives are 0.
    #[inline(always)]
    pub fn series<const K: usize>(value: S, derivatives: [S; K]) -> Self {
        let mut series = Self::constant(value);
        for (slot, derivative) in series.tangent.iter_mut().zip(derivatives) {
            *slot = derivative;
        }
        series
    }

    /// The vector x moving along its own N axes, as directions `first` to `first + N - 1`.
    #[inline(always)]
    pub fn along_axes<const N: usize>(x: &[S; N], first: usize) -> [Self; N] {
        let mut moving = x.map(Self::constant);
        for (jet, k) in moving.iter_mut().zip(first..) {
            if let Some(slot) = jet.tangent.get_mut(k) {
                *slot = S::one();
            }
        }
        moving
    }

    /// x + y and the sums of their tangents.
    #[inline(always)]
    pub fn plus(&self, other: &Self) -> Self {
        let mut sum = *self;
        sum.value += other.value;
        for (s, t) in sum.tangent.iter_mut().zip(&other.tangent) {
            *s += *t;
        }
        sum
    }

    /// cx and cẋ_k for a constant c.
    #[inline(always)]
    pub fn scaled(&self, c: S) -> Self {
        self.chain(c * self.value, c)
    }

    /// Drops the tangents.
    #[inline(always)]
    pub fn without_tangents(&self) -> Jet<S, 0> {
        Jet { value: self.value, tangent: [] }
    }
}

impl<S: Scalar> Jet<S, 1> {
    /// The vector x moving with the velocity `dx`.
    #[inline(always)]
    pub fn moving<const N: usize>(x: &[S; N], dx: &[S; N]) -> [Self; N] {
        core::array::from_fn(|i| Self { value: x[i], tangent: [dx[i]] })
    }

    /// The tangent.
    #[inline(always)]
    pub fn rate(&self) -> S {
        let [rate] = self.tangent;
        rate
    }
}
