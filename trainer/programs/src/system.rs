//! Programs of a model, for the solvers and the losses.

use crate::builder::Builder;
use crate::derivative_outputs::DerivativeOutputs;
use crate::energies::Energies;
use crate::operation::Node;
use crate::program::Program;
use crate::reverse::WeightTerm;
use crate::sparsity::Pattern;

/// Terms L = T − V and Q(q, v, τ) of a model, in a form that can be differentiated.
#[derive(Clone, Debug)]
pub struct System {
    builder: Builder,
    n: usize,
    parameters: usize,
    q: Node,
    v: Node,
    tau: Node,
    energies: [Node; 2],
    lagrangian: Node,
    force: Node,
    bends: Option<Node>,
    /// The force without the laws of contacts, and the numbers of these, if there are any.
    contacts: Option<(Node, [Node; 6])>,
}

/// Levels and stops of all coordinates, `None` if none sticks or has stops. What is absent has no effect.
fn contacts(model: &dyn Energies, builder: &mut Builder, tau: Node) -> Option<[Node; 6]> {
    let (grips, stops) = (model.grips(builder, tau), model.stops(builder));
    let mut all = |x: f64| builder.constant(&vec![x; model.n()]);
    let (free, unbounded) =
        ([0.0, 0.0, 1.0].map(&mut all), [f64::NEG_INFINITY, f64::INFINITY, 0.0].map(&mut all));
    let is_there = grips.is_some() || stops.is_some();
    let ([forward, backward, breakaway], [lower, upper, restitution]) =
        (grips.unwrap_or(free), stops.unwrap_or(unbounded));
    is_there.then_some([forward, backward, breakaway, lower, upper, restitution])
}

/// Programs of [`System::separable`].
#[derive(Clone, Debug)]
pub struct Separable {
    /// Force L_q(q), N, with L_qq.
    pub force: Program,
    /// Momentum L_v(v), kg m/s, with M = L_vv.
    pub momentum: Program,
    /// Drag Q(v), N, with ∂Q/∂v.
    pub drag: Option<Program>,
}

impl System {
    /// Writes a model down.
    pub fn new(model: &dyn Energies) -> Self {
        let (mut builder, n) = (Builder::new(), model.n());
        let [q, v, tau] = [(); 3].map(|()| builder.input(n));
        let energies = model.energies(&mut builder, q, v);
        let lagrangian = builder.difference(energies[0], energies[1]);
        let force = model.force(&mut builder, q, v, tau);
        let bends = model.bends(&mut builder);
        let numbers = contacts(model, &mut builder, tau);
        let contacts = numbers.map(|numbers| (model.single_valued(&mut builder, q, v, tau), numbers));
        let parameters = model.parameters();
        Self { builder, n, parameters, q, v, tau, energies, lagrangian, force, bends, contacts }
    }

    /// Returns the system without forces: L alone, over the same weight block.
    #[must_use]
    pub fn conservative(&self) -> Self {
        let mut own = self.clone();
        own.force = own.builder.zeros(own.n);
        Self { bends: None, contacts: None, ..own }
    }

    /// The system without its laws of contacts, and the program of their numbers with inputs q, v, τ and outputs [`Energies::grips`] and
    /// [`Energies::stops`], n rows each; `None` if no coordinate sticks or has stops.
    pub(crate) fn contacts(&self) -> Option<(Self, Program)> {
        let (force, numbers) = self.contacts?;
        let laws = Program::new(&self.builder, &numbers, &[]);
        Some((Self { force, bends: None, contacts: None, ..self.clone() }, laws))
    }

    /// Whether some coordinate may stick or strike a stop.
    pub fn has_contacts(&self) -> bool {
        self.contacts.is_some()
    }

    /// Number of coordinates n.
    pub fn n(&self) -> usize {
        self.n
    }

    /// Length of the weight block, in numbers.
    pub fn parameters(&self) -> usize {
        self.parameters
    }

    /// Program with inputs q, v and the output [`Energies::bends`], n rows; `None` if no force bends.
    pub(crate) fn bends(&self) -> Option<Program> {
        self.bends.map(|bends| Program::new(&self.builder, &[bends], &[]))
    }

    /// Program with inputs q, v; outputs T and V, J, one row each.
    pub fn energies(&self) -> Program {
        Program::new(&self.builder, &self.energies, &[])
    }

    /// Program with inputs q, v, τ; output Q, n rows: the forces besides the control.
    pub fn force(&self) -> Program {
        Program::new(&self.builder, &[self.force], &[])
    }

    /// Program with inputs q, v; outputs L_q and L_v, n rows each.
    pub fn gradient(&self) -> Program {
        let mut builder = self.builder.clone();
        let outputs = self.first(&mut builder);
        Program::new(&builder, &outputs, &[])
    }

    /// Program with inputs q, v, τ; outputs F = L_q + Q and L_v, n rows each.
    pub fn force_and_momentum(&self) -> Program {
        let mut builder = self.builder.clone();
        let [l_q, l_v] = self.first(&mut builder);
        let force = builder.sum(l_q, self.force);
        Program::new(&builder, &[force, l_v], &[])
    }

    /// Program with inputs q, v, τ; outputs L_q − L_vq v + Q + τ, which is M v̇, and M along the directions of its pattern.
    pub fn equation_of_motion(&self) -> (Program, Pattern) {
        let mut builder = self.builder.clone();
        let (outputs, pattern) = self.motion(&mut builder);
        (Program::new(&builder, &outputs, &[]), pattern)
    }

    /// Equation of motion for a single sample ([`Program::of_one_sample`]). For every size of the blocks of M, all
    /// blocks of that size lie side by side; the outputs are the numbers of the right-hand side, and then the entries
    /// of M row by row.
    pub(crate) fn equation_of_motion_in_blocks(&self) -> (Program, Pattern) {
        let mut builder = self.builder.clone();
        let (motion, pattern) = self.motion(&mut builder);
        let mut groups = Vec::new();
        for blocks in pattern.blocks_by_size() {
            let (mut outputs, size) = (Vec::new(), blocks[0].len());
            let rows = (0..size).map(|i| blocks.iter().map(|block| block[i]).collect::<Vec<_>>());
            outputs.extend(rows.map(|rows| builder.gather(motion[0], &rows)).collect::<Vec<_>>());
            for (i, j) in (0..size * size).map(|k| (k / size, k % size)) {
                let entries: Vec<_> = blocks.iter().map(|block| (block[i], block[j])).collect();
                outputs.push(entries_of_mass(&mut builder, (&motion[1..], &pattern), &entries));
            }
            groups.push(outputs);
        }
        (Program::of_one_sample(&builder, &groups), pattern)
    }

    /// Outputs of [`System::equation_of_motion`], with the rows of [`System::residual`]; common parts are computed once.
    pub fn equation_of_motion_with_residual(&self, directions: usize) -> (Program, Pattern) {
        let mut builder = self.builder.clone();
        let (outputs, pattern) = self.motion(&mut builder);
        let rows = self.residual_rows(&mut builder, directions);
        (Program::new(&builder, &outputs, &rows), pattern)
    }

    /// Right-hand side L_q − L_vq v + Q + τ, and M along the directions of its pattern.
    fn motion(&self, builder: &mut Builder) -> (Vec<Node>, Pattern) {
        let [l_q, l_v] = self.first(builder);
        let along = builder.tangents(&[l_v], &[(self.q, self.v)]);
        let right = builder.difference(l_q, along[0]);
        let right = builder.sum(right, self.force);
        let right = builder.sum(right, self.tau);
        let mut outputs = vec![right];
        let pattern = Pattern::new(builder.dependence(l_v, self.v));
        for direction in 0..pattern.directions() {
            let axes = self.axes(builder, pattern.columns(direction));
            outputs.extend(builder.tangents(&[l_v], &[(self.v, axes)]));
        }
        (outputs, pattern)
    }

    /// Program with inputs q, v, τ; its outputs are numbered by [`DerivativeOutputs`].
    pub fn derivatives(&self) -> (Program, DerivativeOutputs) {
        let mut builder = self.builder.clone();
        let [l_q, l_v] = self.first(&mut builder);
        let force = builder.sum(l_q, self.force);
        let mut outputs = vec![force, l_v];
        for of in [self.q, self.v] {
            let columns: Vec<[Node; 2]> = (0..self.n)
                .map(|j| {
                    let axis = self.axis(&mut builder, j);
                    let moved = builder.tangents(&[force, l_v], &[(of, axis)]);
                    [moved[0], moved[1]]
                })
                .collect();
            outputs.extend(columns.iter().map(|[force, _]| *force));
            outputs.extend(columns.iter().map(|[_, momentum]| *momentum));
        }
        (Program::new(&builder, &outputs, &[]), DerivativeOutputs { n: self.n })
    }

    /// Program with inputs q, v, τ; outputs the n columns ∂Q/∂τ_j, n rows each. `None` if no force depends on the control.
    pub fn load_derivatives(&self) -> Option<Program> {
        let mut builder = self.builder.clone();
        if !builder.read_by(&[self.force], builder.operations.len())[self.tau.index()] {
            return None;
        }
        let mut outputs = Vec::new();
        for j in 0..self.n {
            let axis = self.axis(&mut builder, j);
            outputs.extend(builder.tangents(&[self.force], &[(self.tau, axis)]));
        }
        Some(Program::new(&builder, &outputs, &[]))
    }

    /// Programs of L = T(v) − V(q) with drag Q(v), each with inputs q, v, τ. They output L_q and the columns of L_qq;
    /// L_v and the columns of M; Q and the columns of ∂Q/∂v, n rows each. `None` if the system has another form; there
    /// is no drag program if Q = 0.
    pub fn separable(&self) -> Option<Separable> {
        let mut builder = self.builder.clone();
        let [l_q, l_v] = self.first(&mut builder);
        for (node, own) in [(l_q, self.q), (l_v, self.v), (self.force, self.v)] {
            let read = builder.read_by(&[node], builder.operations.len());
            if [self.q, self.v, self.tau].iter().any(|input| *input != own && read[input.index()]) {
                return None;
            }
        }
        Some(Separable {
            force: self.with_columns(l_q, self.q, builder.clone()),
            momentum: self.with_columns(l_v, self.v, builder.clone()),
            drag: (!builder.is_all(self.force, 0.0)).then(|| self.with_columns(self.force, self.v, builder)),
        })
    }

    /// Program that outputs a vector and the columns of its Jacobian.
    fn with_columns(&self, node: Node, x: Node, mut builder: Builder) -> Program {
        let mut outputs = vec![node];
        for j in 0..self.n {
            let axis = self.axis(&mut builder, j);
            outputs.extend(builder.tangents(&[node], &[(x, axis)]));
        }
        Program::new(&builder, &outputs, &[])
    }

    /// Program with inputs q, v, τ, a. It outputs the derivatives of F − L_vq v − M a at constant a: its n columns
    /// ∂/∂q_j, then its n columns ∂/∂v_j, n rows each. M⁻¹ times these columns gives the derivatives of the
    /// acceleration.
    pub fn residual_derivatives(&self) -> Program {
        self.residual_columns(&[self.q, self.v])
    }

    /// Outputs of [`System::residual_derivatives`], followed by the n columns ∂Q/∂τ_j: the load dependence of friction.
    pub fn residual_derivatives_with_control(&self) -> Program {
        self.residual_columns(&[self.q, self.v, self.tau])
    }

    fn residual_columns(&self, of: &[Node]) -> Program {
        let mut builder = self.builder.clone();
        let [l_q, l_v] = self.first(&mut builder);
        let a = builder.input(self.n);
        let rate = builder.tangents(&[l_v], &[(self.q, self.v), (self.v, a)])[0];
        let force = builder.sum(l_q, self.force);
        let residual = builder.difference(force, rate);
        let mut outputs = Vec::new();
        for x in of {
            for j in 0..self.n {
                let axis = self.axis(&mut builder, j);
                outputs.extend(builder.tangents(&[residual], &[(*x, axis)]));
            }
        }
        Program::new(&builder, &outputs, &[])
    }

    /// Program with inputs q, v, τ, then δq and δv of every direction. Its rows are ∂/∂θ \[F·δq + L_v·δv\] with
    /// F = L_q + Q, one per direction.
    ///
    /// All discrete losses are sums of such rows: the implicit function theorem only determines δq and δv.
    pub fn along(&self, directions: usize) -> Program {
        let mut builder = self.builder.clone();
        let mut rows = Vec::new();
        for _ in 0..directions {
            let [dq, dv] = [(); 2].map(|()| builder.input(self.n));
            let rate = builder.tangents(&[self.lagrangian], &[(self.q, dq), (self.v, dv)])[0];
            let work = builder.dot(self.force, dq);
            let sum = builder.sum(rate, work);
            rows.push(self.weight_gradient(&mut builder, sum));
        }
        Program::new(&builder, &[], &rows)
    }

    /// Program with inputs q, v, τ, then δv of every direction. Its rows are ∂/∂θ \[L_v·δv\], one per direction.
    pub fn momentum_along(&self, directions: usize) -> Program {
        let mut builder = self.builder.clone();
        let mut rows = Vec::new();
        for _ in 0..directions {
            let dv = builder.input(self.n);
            let rate = builder.tangents(&[self.lagrangian], &[(self.v, dv)])[0];
            rows.push(self.weight_gradient(&mut builder, rate));
        }
        Program::new(&builder, &[], &rows)
    }

    /// Program with inputs q, v, τ, a, then y of every direction. Its rows are ∂/∂θ \[y·(F − L_vq v − M a)\], one per
    /// direction: the gradient of the Euler–Lagrange residual, and therefore of the acceleration.
    pub fn residual(&self, directions: usize) -> Program {
        let mut builder = self.builder.clone();
        let rows = self.residual_rows(&mut builder, directions);
        Program::new(&builder, &[], &rows)
    }

    fn residual_rows(&self, builder: &mut Builder, directions: usize) -> Vec<Vec<WeightTerm>> {
        let a = builder.input(self.n);
        let rows = (0..directions).map(|_| {
            let y = builder.input(self.n);
            let momentum = builder.tangents(&[self.lagrangian], &[(self.v, y)])[0];
            let rate = builder.tangents(&[momentum], &[(self.q, self.v), (self.v, a)])[0];
            let force = builder.tangents(&[self.lagrangian], &[(self.q, y)])[0];
            let work = builder.dot(self.force, y);
            let force = builder.sum(force, work);
            let sum = builder.difference(force, rate);
            self.weight_gradient(builder, sum)
        });
        rows.collect()
    }

    /// Gradients L_q and L_v.
    fn first(&self, builder: &mut Builder) -> [Node; 2] {
        let one = builder.constant(&[1.0]);
        let adjoints = builder.pull_back(self.lagrangian, one);
        [self.q, self.v].map(|x| adjoints.of(builder, x))
    }

    fn axis(&self, builder: &mut Builder, j: usize) -> Node {
        self.axes(builder, [j])
    }

    /// Sum of unit vectors.
    fn axes(&self, builder: &mut Builder, of: impl IntoIterator<Item = usize>) -> Node {
        let mut axes = vec![0.0; self.n];
        of.into_iter().for_each(|j| axes[j] = 1.0);
        builder.constant(&axes)
    }

    fn weight_gradient(&self, builder: &mut Builder, of: Node) -> Vec<WeightTerm> {
        let one = builder.constant(&[1.0]);
        builder.pull_back(of, one).weights
    }
}

/// Entries of M, from M along the directions of its pattern.
fn entries_of_mass(
    builder: &mut Builder,
    (columns, pattern): (&[Node], &Pattern),
    entries: &[(usize, usize)],
) -> Node {
    let mut sum = builder.zeros(entries.len());
    for (direction, column) in columns.iter().enumerate() {
        let own = |k: &usize| pattern.direction(entries[*k].0, entries[*k].1) == Some(direction);
        let own: Vec<usize> = (0..entries.len()).filter(own).collect();
        let rows: Vec<usize> = own.iter().map(|k| entries[*k].0).collect();
        let part = builder.gather(*column, &rows);
        let part = builder.scatter(part, &own, entries.len());
        sum = builder.sum(sum, part);
    }
    sum
}
