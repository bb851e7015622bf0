//! Equality with statsmodels and scikit-misc on fixtures written by `fixtures/loess_reference.py`.

use serde_json::Value;
use signal::loess::Loess;

fn numbers(v: &Value) -> Vec<f64> {
    let list = v.as_array().unwrap();
    list.iter().map(|x| x.as_f64().unwrap()).collect()
}

#[test]
fn robust_local_regression_equals_the_libraries() {
    let all: Value =
        serde_json::from_str(include_str!("../fixtures/loess_reference.json")).unwrap();
    let (x, y) = (numbers(&all["x"]), numbers(&all["y"]));
    let cases = all["cases"].as_array().unwrap();
    assert_eq!(cases.len(), 7);
    for case in cases {
        let of = |name: &str| case[name].as_u64().unwrap() as usize;
        let loess = Loess {
            span: of("span"),
            degree: of("degree"),
            robust: of("robust"),
        };
        let (ours, theirs) = (loess.smooth(&x, &y).unwrap(), numbers(&case["smooth"]));
        let worst = ours.iter().zip(&theirs).map(|(a, b)| (a - b).abs());
        let worst = worst.fold(0.0, f64::max);
        assert!(worst < 1e-9, "{loess:?}: {worst}");
    }
}
