use super::ModelError;
use super::header::require;
use super::section::take_f32;
use crate::expected::expected;
use crate::forces::{Actuator, Lag};

/// Actuator of a model in its file form: the delay (s), then gain and offset of every coordinate, then the lag T (s) if there is one, four
/// bytes each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ActuatorBytes<'a>(&'a [u8]);

impl<'a> ActuatorBytes<'a> {
    /// Checks and borrows the bytes of a model file.
    ///
    /// # Errors
    /// [`ModelError::OutOfRange`] unless gains are finite and not 0, offsets finite, the delay finite and not negative, and a lag
    /// finite and positive.
    pub fn new(bytes: &'a [u8]) -> Result<Self, ModelError> {
        let mut rest = bytes;
        let delay = take_f32(&mut rest)?;
        require(delay.is_finite() && delay >= 0.0, "delay of the actuator")?;
        let (pairs, mut end) = rest.as_chunks::<8>();
        if !end.is_empty() {
            require(!pairs.is_empty() && end.len() == size_of::<f32>(), "length of the actuator")?;
            let lag = take_f32(&mut end)?;
            require(lag.is_finite() && lag > 0.0, "lag of the actuator")?;
        }
        for pair in pairs {
            let [gain, offset] = numbers(pair)?;
            require(gain.is_finite() && gain != 0.0, "gain of the actuator")?;
            require(offset.is_finite(), "offset of the actuator")?;
        }
        Ok(Self(bytes))
    }

    /// The bytes of the actuator in the file.
    pub const fn bytes(&self) -> &'a [u8] {
        self.0
    }

    /// Number of coordinates.
    pub fn n(&self) -> usize {
        self.0.len().saturating_sub(4) / 8
    }

    /// Delay d, s.
    pub fn delay(&self) -> f32 {
        let mut bytes = self.0;
        expected(take_f32(&mut bytes).ok(), 0.0)
    }

    /// Time constant T of the lag, s; 0 without a lag.
    pub fn lag(&self) -> f32 {
        let (_, mut end) = expected(self.0.get(4..), &[]).as_chunks::<8>();
        take_f32(&mut end).unwrap_or(0.0)
    }

    /// Splits the delay into the number of whole steps of h seconds and the remaining fraction of a step.
    ///
    /// # Errors
    /// [`ModelError::OutOfRange`] for a delay of more than 65,535 steps.
    pub fn delay_at_step(&self, h: f32) -> Result<(u16, f32), ModelError> {
        let steps = self.delay() / h;
        // h must be positive; no range contains NaN.
        require((0.0..=f32::from(u16::MAX)).contains(&steps) && h > 0.0, "delay of the actuator")?;
        // Not negative, so truncation takes the whole steps.
        let whole = steps as u16;
        Ok((whole, steps - f32::from(whole)))
    }

    /// Returns the delay's number of whole steps of h seconds, and the actuator with the remaining delay.
    ///
    /// # Errors
    /// [`ModelError::Lag`] if the actuator has a lag ([`ActuatorBytes::at_step_with_lag`] loads it); [`ModelError::Shape`] if the
    /// actuator has a different number of coordinates, [`ModelError::OutOfRange`] for a delay of more than 65,535 steps.
    pub fn at_step<const N: usize>(&self, h: f32) -> Result<(u16, Actuator<f32, N>), ModelError> {
        if self.lag() > 0.0 {
            return Err(ModelError::Lag { found: true });
        }
        self.without_lag(h)
    }

    /// Returns the delay's number of whole steps of h seconds, the actuator with the remaining delay, and the lag behind that delay.
    ///
    /// # Errors
    /// [`ModelError::Lag`] if the actuator has no lag; else the errors of [`ActuatorBytes::at_step`].
    pub fn at_step_with_lag<const N: usize>(
        &self,
        h: f32,
    ) -> Result<(u16, Actuator<f32, N>, Lag<f32>), ModelError> {
        if self.lag() <= 0.0 {
            return Err(ModelError::Lag { found: false });
        }
        let (whole, actuator) = self.without_lag(h)?;
        Ok((whole, actuator, Lag::new(self.lag() / h, actuator.delay)))
    }

    /// The delay's number of whole steps, and the actuator with the remaining delay.
    fn without_lag<const N: usize>(&self, h: f32) -> Result<(u16, Actuator<f32, N>), ModelError> {
        let mut actuator = Actuator::ideal();
        if self.n() != N {
            return Err(ModelError::Shape {
                what: "coordinates of the actuator",
                found: self.n(),
                compiled: N,
            });
        }
        let (whole, rest) = self.delay_at_step(h)?;
        actuator.delay = rest;
        for ((gain, offset), pair) in actuator.gain.iter_mut().zip(&mut actuator.offset).zip(self.pairs()) {
            [*gain, *offset] = pair;
        }
        Ok((whole, actuator))
    }

    /// Gain and offset of every coordinate, in order.
    pub fn pairs(&self) -> impl Iterator<Item = [f32; 2]> {
        let (pairs, _) = expected(self.0.get(4..), &[]).as_chunks::<8>();
        pairs.iter().map(|pair| expected(numbers(pair).ok(), [1.0, 0.0]))
    }
}

fn numbers(mut pair: &[u8]) -> Result<[f32; 2], ModelError> {
    Ok([take_f32(&mut pair)?, take_f32(&mut pair)?])
}
