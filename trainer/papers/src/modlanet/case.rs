//! Experiments of the paper, and the settings for running them.

use leastaction_core::energy::modular::PairInput;
use leastaction_ground_truth::ManyBody;
use serde::Serialize;

/// One of the paper's experiments.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum Case {
    /// Two pendulums: accelerations, and predictions of 30 s (Table 2, Figure 5).
    #[default]
    DoublePendulum,
    /// Three bodies: accelerations, and predictions of 30 s.
    ThreeBody,
    /// The model of two pendulums applied to chains of 3 and 4, unchanged and fine-tuned (Figure 6).
    ExtendPendulum,
    /// The model of three bodies applied to 4, 5 and 6.
    ExtendBody,
    /// Two pendulums from 10,000 to 1,000,000 samples (Table 4).
    DatasetSize,
    /// Four pendulums and six bodies, learned directly (diverges in the paper).
    DirectLarge,
    /// Two pendulums from 100, 300 and 1,000 samples, without and with noise, beside an MLP of equal size.
    Noise,
}

impl Case {
    /// Number of iterations after which the errors hardly decrease any more.
    pub fn iterations(self, pair: PairInput) -> usize {
        match (self, pair) {
            (Self::ThreeBody | Self::ExtendBody, PairInput::Distance | PairInput::Difference) => 80,
            (Self::ThreeBody | Self::ExtendBody, PairInput::Concat) => 50,
            (Self::ThreeBody | Self::ExtendBody, PairInput::InverseDistance) => 20,
            (Self::DatasetSize, _) => 30,
            (Self::DirectLarge, _) => 40,
            (Self::DoublePendulum | Self::ExtendPendulum, _) => 600,
            (Self::Noise, _) => 150,
        }
    }

    /// Whether the paper compares with other models in this experiment.
    pub fn has_baselines(self) -> bool {
        matches!(self, Self::DoublePendulum | Self::ThreeBody)
    }

    /// System whose data the case can take from a file.
    pub fn system(self) -> Option<ManyBody> {
        match self {
            Self::DoublePendulum | Self::ExtendPendulum | Self::Noise => Some(ManyBody::Pendulum(2)),
            Self::ThreeBody | Self::ExtendBody => Some(ManyBody::Bodies(3)),
            Self::DatasetSize | Self::DirectLarge => None,
        }
    }
}

/// Settings for running a case.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Options {
    /// Input of the bodies' pair potential.
    pub pair: PairInput,
    /// Seed of the initial weights and of generated data.
    pub seed: u64,
    /// Number of Levenberg–Marquardt iterations; `None` for [`Case::iterations`].
    pub iterations: Option<usize>,
    /// Largest number of samples in [`Case::DatasetSize`].
    pub most_samples: usize,
    /// Number of starts of predictions; 0 for no predictions.
    pub starts: usize,
    /// Number of steps of the long run in single precision; 0 for none.
    pub steps: usize,
}

impl Options {
    /// Settings of the printed tables.
    pub fn new(seed: u64) -> Self {
        Self {
            pair: PairInput::InverseDistance,
            seed,
            iterations: None,
            most_samples: 1_000_000,
            starts: 100,
            steps: 1_000_000,
        }
    }

    /// Settings for a first look.
    pub fn quick(seed: u64) -> Self {
        Self { iterations: Some(60), most_samples: 40_000, starts: 10, steps: 100_000, ..Self::new(seed) }
    }
}
