//! Settings of an adapter as a file.

use super::adapter::Tuning;
use super::blocks::Blocks;
use super::limits::Limits;
use super::number::Number;
use super::unfit::{Unfit, check};
use super::verdict::Announcement;
use crate::forces::Coefficient;
use crate::frame::{FrameFault, Framed};
use crate::model::{File, WriteError};
use core::fmt;
use heapless::Vec;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

/// The first four bytes of every file of settings.
pub const SETTINGS_MAGIC: [u8; 4] = *b"LATU";
/// Format version that this build reads and writes.
const FORMAT_VERSION: u8 = 1;

/// Settings of an adapter of any size, as they are written by the host: [`Tuning`] with lists `V` of a number for each coordinate and `F` of
/// the numbers that follow.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Settings<V, F> {
    /// Ticks of half a window, at least 1.
    pub half: u16,
    /// Tick of the adapter, s, above 0.
    pub h: f32,
    /// Standard deviation of the balance of every coordinate, N or N m, above 0.
    pub deviation: V,
    /// Share that is forgotten in a window, from 0 to below 1.
    pub forgotten: f32,
    /// Threshold of a change, above 0.
    pub change: f32,
    /// Dry friction of every coordinate, N or N m, at least 0.
    pub dry: Option<(Coefficient, V)>,
    /// Share of its own inertia that a body keeps, above 0 and at most 1.
    pub kept: f32,
    /// Numbers that follow.
    pub numbers: F,
}

/// A number that follows the machine.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Following {
    /// The number.
    pub number: Number,
    /// Value in the model.
    pub model: f32,
    /// Standard deviation of its distance from the model before anything was seen, at least 0.
    pub prior: f32,
    /// Variance that it gains in a second, up to that of the prior, at least 0.
    pub walk: f32,
    /// Smallest distance in use, at most 0, and largest one, at least 0.
    pub limits: [f32; 2],
}

/// Settings of an adapter with what a control loop needs beside them, for one model.
///
/// The byte table is in `core/FORMAT.md`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SettingsFile<V, F> {
    /// [Fingerprint](crate::model::fingerprint) of the model.
    #[serde(with = "postcard::fixint::le")]
    pub model: u32,
    /// Ticks of the loop in a tick of the adapter, at least 1: those of [`Blocks`](super::Blocks).
    pub block: u16,
    /// The settings.
    pub settings: Settings<V, F>,
    /// Test whether something is attached, if the model has bodies.
    pub announcement: Option<Announcement<f32>>,
}

/// Settings in the memory of a program for N coordinates with places for P numbers.
pub type StoredSettings<const N: usize, const P: usize> = SettingsFile<Vec<f32, N>, Vec<Following, P>>;

impl<const N: usize, const P: usize> StoredSettings<N, P> {
    /// Reads and validates the settings for the model with this [fingerprint](crate::model::fingerprint).
    ///
    /// # Errors
    /// See [`SettingsError`].
    pub fn read(bytes: &[u8], fingerprint: u32) -> Result<Self, SettingsError> {
        Self::open::<N, P>(bytes, fingerprint)
    }
}

impl<V, F> SettingsFile<V, F>
where
    V: AsRef<[f32]> + DeserializeOwned,
    F: AsRef<[Following]> + DeserializeOwned,
{
    /// Reads into lists of any kind, and validates the settings for N coordinates and places for P numbers, of the model with this
    /// [fingerprint](crate::model::fingerprint).
    ///
    /// # Errors
    /// See [`SettingsError`].
    pub fn open<const N: usize, const P: usize>(
        bytes: &[u8],
        fingerprint: u32,
    ) -> Result<Self, SettingsError> {
        let Framed { contents, .. } = Framed::open(bytes, SETTINGS_MAGIC, FORMAT_VERSION)?;
        let read = postcard::take_from_bytes::<Self>(contents).map_err(|_| SettingsError::Malformed)?;
        let (file, []) = read else { return Err(SettingsError::Malformed) };
        let (saved, given) = (file.model, fingerprint);
        if saved != given {
            return Err(SettingsError::OtherModel { saved, given });
        }
        file.validate::<N, P>()?;
        Ok(file)
    }

    fn validate<const N: usize, const P: usize>(&self) -> Result<(), SettingsError> {
        let tuning: Tuning<f32, N, P> = self.settings.tuning()?;
        check(&tuning.numbers, N).map_err(SettingsError::Unfit)?;
        let announced = |of: &Announcement<f32>| {
            let positive = [of.threshold, of.prior].iter().all(|x| x.is_finite() && *x > 0.0);
            let count = self.settings.numbers.as_ref().len();
            positive && of.least >= 0.0 && usize::from(of.number) < count
        };
        let good = self.block >= 1 && self.announcement.as_ref().is_none_or(announced);
        if good { Ok(()) } else { Err(SettingsError::OutOfRange) }
    }
}

/// Largest difference of a tick from that of the settings, as a share: decimals round.
const OTHER_TICK: f32 = 1e-4;

impl<V, F> SettingsFile<V, F> {
    /// Checks that the settings are for a loop with ticks of h seconds.
    ///
    /// # Errors
    /// [`SettingsError::OtherTick`].
    pub fn check_tick(&self, h: f32) -> Result<(), SettingsError> {
        let made_for = self.settings.tick(self.block);
        let fits = (h - made_for).abs() <= OTHER_TICK * made_for;
        if fits { Ok(()) } else { Err(SettingsError::OtherTick { made_for, given: h }) }
    }
}

impl<V: Serialize, F: Serialize> SettingsFile<V, F> {
    /// Writes the file to the front of `memory`, and returns that part. Nothing is validated; [`StoredSettings::read`] does that.
    ///
    /// # Errors
    /// [`WriteError::TooShort`] if the memory is too short.
    pub fn write<'m>(&self, memory: &'m mut [u8]) -> Result<&'m [u8], WriteError> {
        let mut file = File::begin(memory, SETTINGS_MAGIC, FORMAT_VERSION)?;
        file.document(self)?;
        file.close()
    }
}

impl<V, F> Settings<V, F> {
    /// Motion of a loop of which `block` ticks are one of the adapter.
    pub fn blocks<const N: usize>(&self, block: u16) -> Blocks<f32, N> {
        Blocks::new(block, self.tick(block))
    }

    /// Tick of such a loop, s.
    fn tick(&self, block: u16) -> f32 {
        self.h / f32::from(block.max(1))
    }
}

impl<V: AsRef<[f32]>, F: AsRef<[Following]>> Settings<V, F> {
    /// The settings for N coordinates and places for P numbers; places that are left over have no number.
    ///
    /// # Errors
    /// [`SettingsError::Coordinates`], [`SettingsError::Places`], [`SettingsError::OutOfRange`] and [`SettingsError::Number`].
    pub fn tuning<const N: usize, const P: usize>(&self) -> Result<Tuning<f32, N, P>, SettingsError> {
        let numbers = self.numbers.as_ref();
        if numbers.len() > P {
            return Err(SettingsError::Places { found: numbers.len() as u16, places: P as u16 });
        }
        if !self.in_range() {
            return Err(SettingsError::OutOfRange);
        }
        if let Some(index) = numbers.iter().position(|number| !number.in_range()) {
            return Err(SettingsError::Number { index: index as u8 });
        }
        let dry = match &self.dry {
            Some((coefficient, levels)) => Some((*coefficient, of_coordinates(levels)?)),
            None => None,
        };
        let limits = Limits {
            model: each(numbers, |number| number.model),
            lower: each(numbers, |number| number.limits[0]),
            upper: each(numbers, |number| number.limits[1]),
            kept: self.kept,
        };
        Ok(Tuning {
            numbers: each(numbers, |number| number.number),
            half: self.half,
            h: self.h,
            deviation: of_coordinates(&self.deviation)?,
            prior: each(numbers, |number| number.prior),
            forgotten: self.forgotten,
            walk: each(numbers, |number| number.walk),
            change: self.change,
            limits,
            dry,
        })
    }

    /// Whether every setting that is not one of a number is in its range. A threshold of a change may be infinite.
    fn in_range(&self) -> bool {
        let finite = |x: f32| x.is_finite();
        let deviations = self.deviation.as_ref().iter().all(|x| finite(*x) && *x > 0.0);
        let dry = self.dry.iter().flat_map(|(_, levels)| levels.as_ref()).all(|x| finite(*x) && *x >= 0.0);
        let shares = (0.0..1.0).contains(&self.forgotten) && self.kept > 0.0 && self.kept <= 1.0;
        self.half >= 1 && finite(self.h) && self.h > 0.0 && self.change > 0.0 && shares && deviations && dry
    }
}

impl Following {
    fn in_range(&self) -> bool {
        let Self { model, prior, walk, limits: [lower, upper], .. } = *self;
        let finite = [model, prior, walk, lower, upper].iter().all(|x| x.is_finite());
        finite && prior >= 0.0 && walk >= 0.0 && lower <= 0.0 && upper >= 0.0
    }
}

/// A property of every number, and its default at the places that are left over.
fn each<T: Copy + Default, const P: usize>(numbers: &[Following], of: fn(&Following) -> T) -> [T; P] {
    let mut all = [T::default(); P];
    all.iter_mut().zip(numbers).for_each(|(place, number)| *place = of(number));
    all
}

/// Numbers of all coordinates.
fn of_coordinates<V: AsRef<[f32]>, const N: usize>(numbers: &V) -> Result<[f32; N], SettingsError> {
    let numbers = numbers.as_ref();
    numbers
        .try_into()
        .map_err(|_| SettingsError::Coordinates { found: numbers.len() as u16, needed: N as u16 })
}

/// Reason for refusing settings of an adapter.
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum SettingsError {
    /// The file is no whole file of settings of this version.
    Frame(FrameFault),
    /// The file is not a postcard document of this format, or has more numbers or coordinates than the program has places.
    Malformed,
    /// Settings for another number of coordinates.
    Coordinates {
        /// Coordinates of the settings.
        found: u16,
        /// Coordinates of the model.
        needed: u16,
    },
    /// More numbers than there are places.
    Places {
        /// Numbers that follow.
        found: u16,
        /// Places of the program.
        places: u16,
    },
    /// A setting is not finite, or out of its range.
    OutOfRange,
    /// A value of a number is not finite, or out of its range.
    Number {
        /// Position of the number in the settings, from 0.
        index: u8,
    },
    /// The numbers cannot follow the machine together.
    Unfit(Unfit),
    /// The settings are for a loop with other ticks.
    OtherTick {
        /// Tick that the settings were made for, s.
        made_for: f32,
        /// Tick of the loop, s.
        given: f32,
    },
    /// The settings were written for another model.
    OtherModel {
        /// Fingerprint of the model that the settings were written for.
        saved: u32,
        /// Fingerprint of the model given.
        given: u32,
    },
}

impl From<FrameFault> for SettingsError {
    fn from(fault: FrameFault) -> Self {
        Self::Frame(fault)
    }
}

impl fmt::Display for SettingsError {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::Frame(fault) => fault.fmt(f),
            Self::Malformed => write!(f, "the settings are malformed, or too many for the program"),
            Self::Coordinates { found, needed } => {
                write!(f, "settings for {found} coordinates, but there are {needed}")
            }
            Self::Places { found, places } => {
                write!(f, "{found} numbers, but at most {places} can follow the machine")
            }
            Self::OutOfRange => write!(f, "a setting is not finite, or out of its range"),
            Self::Number { index } => {
                write!(f, "a value of number {index}, counted from 0, is not finite, or out of its range")
            }
            Self::Unfit(unfit) => unfit.fmt(f),
            Self::OtherTick { made_for, given } => {
                write!(f, "made for ticks of {made_for} s, but the loop has {given} s")
            }
            Self::OtherModel { saved, given } => {
                write!(f, "made for the model with fingerprint {saved:08x}, but the model has {given:08x}")
            }
        }
    }
}

impl core::error::Error for SettingsError {}
