//! Cubic B-splines on a uniform grid (Unser 1999).

/// Weights of the four coefficients about a point a part `t` after the second of them.
pub(super) fn weights(t: f64) -> [f64; 4] {
    let s = 1.0 - t;
    [
        s * s * s / 6.0,
        (4.0 - 6.0 * t * t + 3.0 * t * t * t) / 6.0,
        (4.0 - 6.0 * s * s + 3.0 * s * s * s) / 6.0,
        t * t * t / 6.0,
    ]
}

/// Derivatives of the weights by `t`.
pub(super) fn slopes(t: f64) -> [f64; 4] {
    let s = 1.0 - t;
    [
        -0.5 * s * s,
        -2.0 * t + 1.5 * t * t,
        2.0 * s - 1.5 * s * s,
        0.5 * t * t,
    ]
}

/// Coefficients of the cubic B-spline through a uniformly sampled signal, mirrored at its ends.
pub(super) fn b_spline(x: &[f64]) -> Vec<f64> {
    let pole = 3.0_f64.sqrt() - 2.0;
    let n = x.len();
    if n < 2 {
        return x.to_vec();
    }
    let mut c: Vec<f64> = x.iter().map(|v| 6.0 * v).collect();
    // The pole's powers fall below the last digit after 30 samples.
    let mut power = 1.0;
    let mut first = 0.0;
    for v in c.iter().take(30) {
        first += power * v;
        power *= pole;
    }
    c[0] = first;
    for k in 1..n {
        c[k] += pole * c[k - 1];
    }
    c[n - 1] = pole / (pole * pole - 1.0) * (c[n - 1] + pole * c[n - 2]);
    for k in (0..n - 1).rev() {
        c[k] = pole * (c[k + 1] - c[k]);
    }
    c
}
