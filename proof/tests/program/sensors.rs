//! Recordings with a link encoder or a thermometer.

use crate::case::{Case, causes};
use serde_json::Value;

/// One joint that turns about a plumb line: its load is inertia alone.
const TURNTABLE: &str = r#"<robot name="arm"><link name="base"/><link name="l1"><inertial><origin xyz="0.1 0 0"/><mass value="1"/>
<inertia ixx="0.3" ixy="0" ixz="0" iyy="0.3" iyz="0" izz="0.49"/></inertial></link>
<joint name="j1" type="revolute"><parent link="base"/><child link="l1"/><axis xyz="0 0 1"/>
<limit lower="-2" upper="2" velocity="3" effort="50"/><dynamics damping="0.4" friction="0.3"/></joint></robot>"#;
/// Its inertia, kg·m².
const INERTIA: f64 = 0.5;
/// Samples of each of six trajectories.
const SAMPLES: u32 = 1500;

/// Uniform noise around zero.
struct Noise(u32);

impl Noise {
    fn next(&mut self, width: f64) -> f64 {
        self.0 = self.0.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        width * (f64::from(self.0 >> 8) / f64::from(1u32 << 24) - 0.5)
    }
}

/// Rows of a recording; `row` says what stands there at a time of a session, for the link's position and its first three derivatives.
fn table(
    header: &str,
    shift: f64,
    mut row: impl FnMut(f64, [f64; 4], &mut Noise) -> String,
) -> String {
    let (mut text, mut noise) = (format!("trajectory,time,{header}\n"), Noise(1));
    for trajectory in 0..6 {
        for i in 0..SAMPLES {
            let t = f64::from(i) * 0.008;
            let a = f64::from(trajectory) + shift;
            let motions = [(0.6, 1.7 + 0.1 * a, a), (0.3, 3.9 - 0.13 * a, 0.0)];
            let mut q = [0.0; 4];
            for (size, w, phase) in motions {
                let (sin, cos) = (w * t + phase).sin_cos();
                for (k, x) in [sin, w * cos, -w * w * sin, -w.powi(3) * cos]
                    .into_iter()
                    .enumerate()
                {
                    q[k] += size * x;
                }
            }
            let now = f64::from(trajectory) * f64::from(SAMPLES) * 0.008 + t;
            text.push_str(&format!("{trajectory},{now},{}\n", row(now, q, &mut noise)));
        }
    }
    text
}

/// The turntable behind a spring, its motor at q and its link, of which the load is known, at ql; without a stiffness behind none. `seen`
/// is what the link's encoder makes of ql.
fn wound_up(stiffness: Option<f64>, shift: f64, seen: impl Fn(f64) -> f64) -> String {
    table("q1,ql1,tau1", shift, |_, [q, qd, qdd, jerk], noise| {
        let (load, rate) = (INERTIA * qdd, INERTIA * jerk);
        let soft = stiffness.map_or(0.0, |k| 1.0 / k);
        let (motor, speed) = (q + soft * load, qd + soft * rate);
        let tau = load + 0.4 * speed + 0.3 * speed.signum() + noise.next(0.004);
        let link = seen(q) + noise.next(2e-5);
        format!("{},{},{}", motor + noise.next(2e-5), link, tau)
    })
}

/// A folder with the turntable and two recordings.
fn turntable(a: &str, b: &str) -> Case {
    let case = Case::new(a, b);
    case.write("arm.urdf", TURNTABLE);
    case
}

/// A parameter of a report's first cause: its value and deviation.
fn parameter(report: &Value, name: &str) -> (f64, f64) {
    let list = report["causes"][0]["parameters"].as_array().unwrap();
    let own = list.iter().find(|p| p["name"] == name);
    let own = own.unwrap_or_else(|| panic!("no {name} in {report:#}"));
    (
        own["value"].as_f64().unwrap(),
        own["std"].as_f64().unwrap_or(f64::NAN),
    )
}

/// The link's encoder measures what the gear gives way: a stiffness that is held by its own interval, whatever the encoder's zero.
#[test]
fn a_link_encoder_tells_the_stiffness() {
    let seen = |q: f64| q + 0.013;
    let case = turntable(
        &wound_up(Some(100.0), 0.0, seen),
        &wound_up(Some(100.0), 0.45, seen),
    );
    let report = case.report(&["--fast"]);
    assert_eq!(causes(&report)[0], "joint_elasticity", "{report:#}");
    assert_eq!(report["causes"][0]["confirmed"], true);
    let (stiffness, std) = parameter(&report, "stiffness");
    assert!(
        (stiffness - 100.0).abs() < 1.645 * std,
        "{stiffness} ± {std}"
    );
    assert!(std < 8.0, "{std}");
}

/// A link that stands where its motor does has no elastic gear, and nothing is said of it.
#[test]
fn a_stiff_gear_is_no_cause() {
    let case = turntable(&wound_up(None, 0.0, |q| q), &wound_up(None, 0.45, |q| q));
    let report = case.report(&["--fast"]);
    assert_eq!(report["verdict"], "no_gap", "{report:#}");
    assert!(causes(&report).is_empty());
}

/// A column that cannot be the link's position is left out with a reason, and all else is as without it.
#[test]
fn what_is_no_link_is_left_out_and_said() {
    let degrees = |q: f64| q.to_degrees();
    let own = wound_up(Some(100.0), 0.0, degrees);
    let other = wound_up(Some(100.0), 0.45, degrees);
    let report = turntable(&own, &other).report(&["--fast"]);
    let without = |text: &str| {
        let cut = |line: &str| {
            let cells: Vec<&str> = line.split(',').collect();
            format!("{},{},{},{}\n", cells[0], cells[1], cells[2], cells[4])
        };
        text.lines().map(cut).collect::<String>()
    };
    let plain = turntable(&without(&own), &without(&other)).report(&["--fast"]);
    let said: Vec<Value> = report["notes"].as_array().unwrap().clone();
    let refused = said
        .iter()
        .filter(|n| n.as_str().unwrap().contains("ql is not used"));
    assert_eq!(refused.count(), 2, "{said:#?}");
    for (key, own) in report.as_object().unwrap() {
        // Where the files lie is another.
        if !["notes", "recordings"].contains(&key.as_str()) {
            assert_eq!(*own, plain[key], "{key}");
        }
    }
}

/// Friction that goes with a temperature which goes up and down: no clock tells it, and the report's slope is the true one.
#[test]
fn a_thermometer_tells_friction_by_warmth() {
    let of = |shift: f64| {
        table("q1,temp1,tau1", shift, |now, [q, qd, qdd, _], noise| {
            let warm = 12.0 * (now / 11.0 + shift).sin().powi(2);
            let tau =
                INERTIA * qdd + (0.4 - 0.012 * warm) * qd + 0.3 * qd.signum() + noise.next(0.004);
            let seen = ((24.0 + warm + noise.next(0.2)) * 10.0).round() / 10.0;
            format!("{q},{seen},{tau}")
        })
    };
    let case = turntable(&of(0.0), &of(0.45));
    let report = case.report(&["--fast", "--patch", "@p.urdf"]);
    assert_eq!(causes(&report)[0], "friction_drift", "{report:#}");
    let (slope, std) = parameter(&report, "viscous_per_kelvin");
    assert!(
        (slope + 0.012).abs() < (3.0 * std).max(6e-4),
        "{slope} ± {std}"
    );
    let (reference, _) = parameter(&report, "reference_temperature");
    assert!((23.5..25.0).contains(&reference), "{reference}");
    // No simulator has a joint's temperature: the table of values says where it stands.
    let table = std::fs::read_to_string(case.path("p.values.tsv")).unwrap_or_default();
    assert!(!table.contains("generated code"), "{table}");
}
