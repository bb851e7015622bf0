//! Equality with SciPy on fixtures written by `fixtures/scipy_reference.py`.

use serde_json::Value;
use signal::spline::{CubicEnd, Spline};
use signal::{differences, filter, sos, spectrum};

fn reference() -> Value {
    serde_json::from_str(include_str!("../fixtures/scipy_reference.json")).unwrap()
}

fn numbers(v: &Value) -> Vec<f64> {
    v.as_array()
        .unwrap()
        .iter()
        .map(|x| x.as_f64().unwrap())
        .collect()
}

fn assert_close(ours: &[f64], theirs: &[f64], tolerance: f64, what: &str) {
    assert_eq!(ours.len(), theirs.len(), "{what}");
    for (i, (a, b)) in ours.iter().zip(theirs).enumerate() {
        assert!(
            (a - b).abs() <= tolerance * b.abs().max(1.0),
            "{what}[{i}]: {a} instead of {b}"
        );
    }
}

/// |H| at a frequency.
fn gain(sections: &[sos::Section], frequency: f64, rate: f64) -> f64 {
    let w = 2.0 * std::f64::consts::PI * frequency / rate;
    let size = |c0: f64, c1: f64, c2: f64| {
        let re = c0 + c1 * w.cos() + c2 * (2.0 * w).cos();
        let im = c1 * w.sin() + c2 * (2.0 * w).sin();
        re.hypot(im)
    };
    sections
        .iter()
        .map(|s| size(s.b[0], s.b[1], s.b[2]) / size(1.0, s.a[0], s.a[1]))
        .product()
}

#[test]
fn filters_equal_scipy() {
    let all = reference();
    let x = numbers(&all["x"]);
    let rate = all["rate"].as_f64().unwrap();
    let filters = all["filters"].as_array().unwrap();
    assert_eq!(filters.len(), 9);
    for f in filters {
        let order = f["order"].as_u64().unwrap() as usize;
        let cutoff = f["cutoff"].as_f64().unwrap();
        let kind = f["kind"].as_str().unwrap();
        let sections = match kind {
            "butter" => sos::butterworth(order, cutoff, rate),
            _ => sos::chebyshev1(order, 0.2, cutoff, rate),
        }
        .unwrap();
        let name = format!("{kind} {order}");
        let gains = [0.0, 1.0, cutoff, 40.0].map(|f| gain(&sections, f, rate));
        assert_close(&gains, &numbers(&f["gain"]), 1e-12, &name);
        let causal = filter::filter(&sections, &x);
        assert_close(&causal, &numbers(&f["causal"]), 1e-11, &name);
        let zero_phase = filter::filtfilt(&sections, &x);
        assert_close(&zero_phase, &numbers(&f["zero_phase"]), 1e-11, &name);
    }
}

#[test]
fn splines_equal_scipy() {
    let all = reference();
    let s = &all["splines"];
    let (time, values, at) = (
        numbers(&s["time"]),
        numbers(&s["values"]),
        numbers(&s["at"]),
    );
    for (name, spline) in [
        ("quintic", Spline::quintic(&time, &values)),
        (
            "not_a_knot",
            Spline::cubic(&time, &values, CubicEnd::NotAKnot),
        ),
        ("natural", Spline::cubic(&time, &values, CubicEnd::Natural)),
    ] {
        let ours = spline.unwrap().sample(&at);
        // Derivatives grow by the inverse of the step (about 10 to 20 per second) each.
        for (order, tolerance) in [1e-11, 1e-10, 1e-9].into_iter().enumerate() {
            let what = format!("{name}, derivative {order}");
            assert_close(&ours[order], &numbers(&s[name][order]), tolerance, &what);
        }
    }
    let gradient = differences::differences(&time, &values);
    assert_close(&gradient, &numbers(&s["gradient"]), 1e-12, "gradient");
}

#[test]
fn spectra_equal_scipy() {
    let all = reference();
    let x = numbers(&all["x"]);
    let rate = all["rate"].as_f64().unwrap();
    for (name, ours) in [
        ("periodogram", spectrum::periodogram(&x, rate)),
        ("welch", spectrum::welch(&x, rate, 16)),
    ] {
        assert_close(
            &ours.frequency,
            &numbers(&all[name]["frequency"]),
            1e-14,
            name,
        );
        assert_close(&ours.density, &numbers(&all[name]["density"]), 1e-12, name);
    }
}
