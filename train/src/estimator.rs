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
    /// Weight function of irls and iterative: weight of a row by its residual.
    #[arg(long, value_enum, default_value_t = WeightName::Hard)]
    pub weight: WeightName,
    /// Steps of the estimate in which every link must be a possible body (mass and inertia that matter can have).
    #[arg(long, value_enum, default_value_t = LmiName::Off)]
    pub lmi: LmiName,
    /// Parameters that the ridge pulls towards: "nominal" (the robot's description) or those of an older model
    /// directory.
    #[arg(long, value_name = "nominal|DIR")]
    pub prior: Option<String>,
    /// Strength of the ridge relative to each column's norm [default: 3e-5; with --prior 0.1].
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
    /// As wls, with rows also weighted by their own residual, until outliers have no influence.
    Irls,
    /// Noise covariance between joints, outliers, and friction exponent together.
    Iterative,
}

/// Names of the weight functions.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum WeightName {
    /// Weight zero beyond three deviations.
    Hard,
    /// Weight falling as 1/|r| beyond 1.345 deviations.
    Huber,
    /// Weight falling smoothly to zero at 4.685 deviations.
    Tukey,
}

/// Names of the steps in which links must be possible.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum LmiName {
    /// Never.
    Off,
    /// In the last step only.
    Last,
    /// In every step.
    Every,
}

impl EstimatorArguments {
    /// The settings for `robot`.
    ///
    /// # Errors
    /// A ridge outside of 0 to 1000; a prior that cannot be read, or that belongs to another robot.
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
