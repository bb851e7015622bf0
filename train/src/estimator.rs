//! Arguments that choose how parameters are estimated.

use clap::{Args, ValueEnum};
use identify::iterative::Weight;
use model::directory::ModelFile;
use model::failure::Failure;
use model::identify::estimators::{Estimator, EstimatorOptions, Known, Lmi};
use physics::robot::Robot;
use std::path::Path;

/// How parameters are estimated.
#[derive(Clone, Debug, Args)]
pub struct EstimatorArguments {
    /// Estimator of the parameters.
    #[arg(long, value_enum, default_value_t = EstimatorName::Wls)]
    pub estimator: EstimatorName,
    /// How irls and iterative weigh a row by its residual.
    #[arg(long, value_enum, default_value_t = WeightName::Hard)]
    pub weight: WeightName,
    /// When every link has to be a possible body.
    #[arg(long, value_enum, default_value_t = LmiName::Off)]
    pub lmi: LmiName,
    /// What the ridge pulls towards: "nominal" (the robot's description) or an older model directory.
    #[arg(long, value_name = "nominal|DIR")]
    pub prior: Option<String>,
    /// Ridge relative to each column's norm [default: 3e-5, with --prior 0.1].
    #[arg(long)]
    pub ridge: Option<f64>,
}

/// Names of the estimators.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum EstimatorName {
    /// Ordinary least squares.
    Ols,
    /// Rows weighted by their joint's residual deviation.
    Wls,
    /// And by their own residual, until outliers have no say.
    Irls,
    /// Noise covariance between joints, outliers, and friction exponent together.
    Iterative,
}

/// Names of the weight functions.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum WeightName {
    /// None beyond three deviations.
    Hard,
    /// Falling as 1/|r| beyond 1.345 deviations.
    Huber,
    /// Falling smoothly to none at 4.685 deviations.
    Tukey,
}

/// Names of the steps in which links must be possible.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum LmiName {
    /// In none.
    Off,
    /// In the last one.
    Last,
    /// In every one.
    Every,
}

impl EstimatorArguments {
    /// The settings for `robot`.
    ///
    /// # Errors
    /// A ridge that is none, a prior that cannot be read or belongs to another robot.
    pub fn options(&self, robot: &Robot) -> Result<EstimatorOptions, Failure> {
        if let Some(ridge) = self.ridge.filter(|r| !(0.0..=1e3).contains(r)) {
            return Err(Failure::input(
                format!("--ridge {ridge}: it must be between 0 and 1000"),
                "It is relative to the columns: 1e-5 holds what the data cannot see, 0.1 pulls hard.",
            ));
        }
        let prior = match self.prior.as_deref() {
            None => None,
            Some("nominal") => Some(Known::nominal(robot)),
            Some(directory) => {
                let file = ModelFile::load(Path::new(directory))?;
                Some(file.known(robot).map_err(|e| {
                    Failure::input(e.to_string(), "Give a model directory of the same robot.")
                })?)
            }
        };
        Ok(EstimatorOptions {
            estimator: match self.estimator {
                EstimatorName::Ols => Estimator::Ols,
                EstimatorName::Wls => Estimator::Wls,
                EstimatorName::Irls => Estimator::Irls,
                EstimatorName::Iterative => Estimator::Iterative,
            },
            weight: match self.weight {
                WeightName::Hard => Weight::Hard { threshold: 3.0 },
                WeightName::Huber => Weight::Huber { threshold: 1.345 },
                WeightName::Tukey => Weight::Tukey { threshold: 4.685 },
            },
            lmi: match self.lmi {
                LmiName::Off => Lmi::Off,
                LmiName::Last => Lmi::Last,
                LmiName::Every => Lmi::Every,
            },
            prior,
            ridge: self.ridge,
            given: None,
        })
    }
}
