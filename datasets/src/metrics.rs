//! Figures of merit of the KR300 benchmark (Weigand et al. 2022, equations 5–10), for torques and,
//! in the forward task, for positions: the one implementation behind `eval`, `diagnose` and the
//! simulator's oracle.

use ndarray::{Array2, ArrayView1, ArrayView2};
use serde::{Deserialize, Serialize};

/// Speed above which a sample of a joint counts as in motion, rad/s or m/s.
pub const MOVING: f64 = 0.01;

/// Speed below which a joint counts as never moving, if it stays below it throughout; rad/s or m/s. It is well
/// below [`MOVING`], so that slow motion still counts, and above the derivative of encoder noise.
pub const REST: f64 = 1e-3;

/// Set of samples that is scored.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Scope {
    /// Scope of every sample.
    All,
    /// Scope of motion: for each joint, the samples in which it moves faster than [`MOVING`].
    Moving,
}

impl Scope {
    /// Both scopes, in the order of the reports.
    pub const BOTH: [Self; 2] = [Self::All, Self::Moving];

    /// The name in files and tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::All => "all",
            Self::Moving => "moving",
        }
    }
}

/// Figures per joint and their means over joints. `None` (null in JSON) where a figure does not
/// exist; the means leave those joints out.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Scores {
    /// Root mean squared error, in the unit of the quantity; none where the scope has no sample.
    pub rmse: Vec<Option<f64>>,
    /// RMSE over the standard deviation of the measured quantity over all samples, whatever the scope
    /// (equation 5). None also for a joint that never moves and for a quantity that never varies.
    pub nrmse: Vec<Option<f64>>,
    /// 100·(1 − NRMSE²) in percent (equation 6).
    pub r2: Vec<Option<f64>>,
    /// Mean NRMSE over joints (equation 9).
    pub mean_nrmse: Option<f64>,
    /// Mean R² over joints (equation 10).
    pub mean_r2: Option<f64>,
}

/// One row of `eval`'s output: a model's name, the scope and its scores.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// `linear_baseline`, `physics`, `physics+compensator`, …
    pub name: String,
    /// Set of samples that was scored.
    pub scope: Scope,
    /// Scores of the model, in the same JSON object.
    #[serde(flatten)]
    pub scores: Scores,
}

/// Tables that do not belong together.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{what} has the shape {found:?} where the measured table has {expected:?}")]
pub struct ShapeError {
    /// The table with the wrong shape.
    pub what: &'static str,
    /// Shape of the table found (samples, joints).
    pub found: (usize, usize),
    /// Shape of the measured table.
    pub expected: (usize, usize),
}

impl Scores {
    /// Scores `predicted` against `measured` over the samples of the scope, which follows from the speeds `qd`.
    /// All three have shape (samples, joints), `qd` in rad/s or m/s.
    ///
    /// # Errors
    /// Tables of different shapes.
    pub fn of(
        measured: ArrayView2<f64>,
        predicted: ArrayView2<f64>,
        qd: ArrayView2<f64>,
        scope: Scope,
    ) -> Result<Self, ShapeError> {
        for (what, table) in [("the prediction", predicted), ("the velocity", qd)] {
            if table.dim() != measured.dim() {
                return Err(ShapeError {
                    what,
                    found: table.dim(),
                    expected: measured.dim(),
                });
            }
        }
        Self::of_errors(
            (&measured - &predicted).view(),
            &deviations(measured, qd),
            qd,
            scope,
            |_| true,
        )
    }

    /// Scores errors (measured − predicted) of shape (samples, joints) over the samples that `counted` keeps
    /// and that lie in the scope, which follows from `qd`. `deviations`, one per joint, are those of the
    /// measured quantity over all samples, counted or not, as [`deviations`] gives them.
    ///
    /// # Errors
    /// Tables of different shapes.
    pub fn of_errors(
        errors: ArrayView2<f64>,
        deviations: &[Option<f64>],
        qd: ArrayView2<f64>,
        scope: Scope,
        counted: impl Fn(usize) -> bool,
    ) -> Result<Self, ShapeError> {
        let expected = errors.dim();
        for (what, found) in [
            ("the velocity", qd.dim()),
            ("the deviation", (expected.0, deviations.len())),
        ] {
            if found != expected {
                return Err(ShapeError {
                    what,
                    found,
                    expected,
                });
            }
        }
        let rmse = std::iter::zip(errors.columns(), qd.columns()).map(|(error, speed)| {
            let squares: Vec<f64> = std::iter::zip(error, speed)
                .enumerate()
                .filter(|(row, (_, v))| counted(*row) && (scope == Scope::All || v.abs() > MOVING))
                .map(|(_, (e, _))| e.powi(2))
                .collect();
            finite((squares.iter().sum::<f64>() / squares.len() as f64).sqrt())
        });
        Ok(Self::relative(rmse.collect(), deviations))
    }

    /// Relative figures from each joint's RMSE and the standard deviation of its measured quantity.
    pub fn relative(rmse: Vec<Option<f64>>, deviations: &[Option<f64>]) -> Self {
        let nrmse: Vec<Option<f64>> = std::iter::zip(&rmse, deviations)
            .map(|(error, deviation)| finite((*error)? / (*deviation)?))
            .collect();
        let r2: Vec<Option<f64>> = nrmse
            .iter()
            .map(|e| e.map(|e| 100.0 * (1.0 - e * e)))
            .collect();
        Self {
            mean_nrmse: mean(&nrmse),
            mean_r2: mean(&r2),
            rmse,
            nrmse,
            r2,
        }
    }
}

/// Divisors of each joint's errors: the standard deviation of the measured quantity over all samples. None for
/// a joint that never moves ([`REST`]) and for a quantity that never varies. Both tables have shape (samples,
/// joints), `qd` in rad/s or m/s.
pub fn deviations(measured: ArrayView2<f64>, qd: ArrayView2<f64>) -> Vec<Option<f64>> {
    std::iter::zip(measured.columns(), qd.columns())
        .map(|(y, speed)| deviation(y).filter(|_| speed.iter().any(|v| v.abs() > REST)))
        .collect()
}

/// Standard deviation of a quantity; none for a constant. A constant's computed deviation is rounding: it is
/// compared with the constant's size, not with zero.
fn deviation(y: ArrayView1<f64>) -> Option<f64> {
    let largest = y.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    finite(y.std(0.0)).filter(|deviation| *deviation > 1e-12 * largest)
}

impl Row {
    /// The rows of one model for both scopes.
    ///
    /// # Errors
    /// Tables of different shapes.
    pub fn both_scopes(
        name: &str,
        measured: &Array2<f64>,
        predicted: &Array2<f64>,
        qd: &Array2<f64>,
    ) -> Result<[Self; 2], ShapeError> {
        let row = |scope| {
            Ok(Self {
                name: name.to_owned(),
                scope,
                scores: Scores::of(measured.view(), predicted.view(), qd.view(), scope)?,
            })
        };
        Ok([row(Scope::All)?, row(Scope::Moving)?])
    }
}

fn finite(value: f64) -> Option<f64> {
    Some(value).filter(|v| v.is_finite())
}

/// Mean of the values that exist; none where none exists.
pub fn mean(values: &[Option<f64>]) -> Option<f64> {
    let present: Vec<f64> = values.iter().flatten().copied().collect();
    finite(present.iter().sum::<f64>() / present.len() as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::array;

    #[test]
    fn figures_by_hand() {
        // Joint 1: errors 1, 1, 1, 3 → RMSE √3 over all; torque 1, 3, 1, 3 → deviation 1.
        // It moves in the first two samples: RMSE 1, still over the deviation of all samples.
        let measured = array![[1.0, 5.0], [3.0, 5.0], [1.0, 5.0], [3.0, 5.0]];
        let predicted = array![[0.0, 5.0], [2.0, 5.0], [0.0, 5.0], [0.0, 7.0]];
        let qd = array![[0.02, 1.0], [-0.5, 1.0], [0.01, 1.0], [0.0, 1.0]];
        let all = Scores::of(measured.view(), predicted.view(), qd.view(), Scope::All).unwrap();
        assert_eq!(all.rmse, [Some(3.0_f64.sqrt()), Some(1.0)]);
        // Joint 2's torque never varies.
        assert_eq!(all.nrmse, [Some(3.0_f64.sqrt()), None]);
        assert!((all.mean_r2.unwrap() + 200.0).abs() < 1e-12);
        assert_eq!(all.mean_nrmse, Some(3.0_f64.sqrt()));

        let moving =
            Scores::of(measured.view(), predicted.view(), qd.view(), Scope::Moving).unwrap();
        assert_eq!(moving.rmse[0], Some(1.0));
        assert_eq!((moving.mean_nrmse, moving.mean_r2), (Some(1.0), Some(0.0)));
    }

    #[test]
    fn a_joint_that_never_moves_has_no_figure() {
        let measured = array![[1.0, 1.0], [2.0, 2.0], [3.0, 4.0]];
        let predicted = &measured + 0.5;
        let qd = array![[0.5, 0.0], [0.5, 1e-5], [0.5, 0.0]];
        for scope in Scope::BOTH {
            let s = Scores::of(measured.view(), predicted.view(), qd.view(), scope).unwrap();
            assert!(s.nrmse[0].is_some());
            assert_eq!((s.nrmse[1], s.r2[1]), (None, None));
            assert_eq!((s.mean_nrmse, s.mean_r2), (s.nrmse[0], s.r2[0]));
            assert_eq!(s.rmse[1].is_some(), scope == Scope::All);
        }
    }

    #[test]
    fn samples_left_out_count_in_the_deviation_alone() {
        let measured = array![[1.0], [3.0], [1.0], [3.0]];
        let qd = array![[0.5], [0.5], [0.5], [0.0]];
        let deviation = deviations(measured.view(), qd.view());
        assert_eq!(deviation, [Some(1.0)]);
        let errors = array![[2.0], [4.0], [9.0], [2.0]];
        let score = |scope| {
            Scores::of_errors(errors.view(), &deviation, qd.view(), scope, |row| row != 2).unwrap()
        };
        assert_eq!(score(Scope::All).nrmse, [Some(8.0_f64.sqrt())]);
        assert_eq!(score(Scope::Moving).nrmse, [Some(10.0_f64.sqrt())]);
        let short = Scores::of_errors(errors.view(), &[], qd.view(), Scope::All, |_| true);
        assert!(short.unwrap_err().to_string().contains("the deviation"));
    }

    #[test]
    fn no_joint_and_no_sample_give_no_mean() {
        let none = Array2::<f64>::zeros((0, 2));
        let s = Scores::of(none.view(), none.view(), none.view(), Scope::All).unwrap();
        assert_eq!((s.rmse, s.mean_nrmse), (vec![None, None], None));
    }

    #[test]
    fn other_shapes_are_refused() {
        let (a, b) = (Array2::<f64>::zeros((3, 2)), Array2::<f64>::zeros((2, 2)));
        let error = Scores::of(a.view(), a.view(), b.view(), Scope::All).unwrap_err();
        assert!(error.to_string().contains("the velocity"), "{error}");
    }

    #[test]
    fn json_has_the_documented_keys() {
        let m = array![[1.0], [2.0]];
        let [row, _] = Row::both_scopes("physics", &m, &m, &m).unwrap();
        let json = serde_json::to_string(&row).unwrap();
        let expected = r#"{"name":"physics","scope":"all","rmse":[0.0],"nrmse":[0.0],"r2":[100.0],"mean_nrmse":0.0,"mean_r2":100.0}"#;
        assert_eq!(json, expected);
        assert_eq!(serde_json::from_str::<Row>(&json).unwrap(), row);
    }
}
