//! In closed loop plain least squares is biased; what asks the reference is not, and says how far off it is.

use decoupled::simulation::Setup;
use decoupled::study::study;

#[test]
fn what_asks_the_reference_is_unbiased() {
    let made = study(16, &Setup::default(), 11).unwrap();
    assert_eq!(made.len(), 6);
    for axis in &made {
        for found in &axis.estimators {
            let worst = found.worst();
            if found.name == "least-squares" {
                assert!(worst > 3.0, "axis {}: {worst}", axis.axis);
                continue;
            }
            assert!(worst < 1.0, "axis {}, {}: {worst}", axis.axis, found.name);
            // Stated deviations are those over the draws: their mean square ratio, of sixteen draws and all parameters.
            let ratio = |(s, r): (&f64, &decoupled::repeats::Repeats)| (r.std / s).powi(2);
            let pairs = found.stated.iter().zip(&found.repeats);
            let mean = pairs.map(ratio).sum::<f64>() / found.stated.len() as f64;
            assert!(
                (0.3..2.0).contains(&mean),
                "axis {}, {}: {mean}",
                axis.axis,
                found.name
            );
        }
        assert!(axis.correlation.abs() < 1e-6, "{}", axis.correlation);
        // Runs for friction and gravity.
        let first = axis.truth.len() - 4;
        for (repeats, truth) in axis.friction[1..].iter().zip(&axis.truth[first..]) {
            let bias = (repeats.mean - truth) / repeats.std;
            assert!(bias.abs() < 1.0, "axis {}: {bias}", axis.axis);
        }
        for (repeats, truth) in axis.gravity.iter().flatten().zip(&axis.truth[1..]) {
            let bias = (repeats.mean - truth) / repeats.std;
            assert!(bias.abs() < 1.0, "axis {}: {bias}", axis.axis);
        }
    }
}
