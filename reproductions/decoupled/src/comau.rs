//! The COMAU Smart-3 S2 of the paper: Tables 2 and 3.

use crate::joint::{Columns, Friction, Joint};

/// Table 3 (inertias and first moments) and Table 2 (friction), axis by axis: Γ, mx, my, β^{v+}, β^{v−}, β^{c+}, β^{c−}. The
/// first axis is upright: gravity does no work about it.
#[rustfmt::skip]
const TABLES: [[f64; 7]; 6] = [
    [28.7822,  0.0,     0.0,    31.8757, 26.0000, 16.1376, 15.0676],
    [64.1881, 39.9920,  6.0617, 36.6197, 73.0530, 65.4187, 45.9598],
    [ 7.4838,  2.8006, -5.6097, 10.6964, 11.5955, 13.3809, 11.3347],
    [ 0.2844, -0.0257,  0.0063,  3.0686,  3.1806,  2.0526,  1.9685],
    [ 0.3541, -0.0518,  0.1428,  3.5672,  3.2386,  1.7545,  1.7161],
    [ 0.4601,  0.0313, -0.0194,  1.8245,  1.9985,  2.4545,  2.4161],
];

/// Standard deviation of Table 3 and its half-width at 99.9 %: of Γ, mx and my, axis by axis.
#[rustfmt::skip]
pub const TABLE_3_SPREAD: [&[[f64; 2]]; 6] = [
    &[[0.3207, 0.2179]],
    &[[1.8838, 1.2800], [0.2252, 0.1530], [0.0539, 0.0366]],
    &[[0.1214, 0.0825], [0.0115, 0.0078], [0.0147, 0.0100]],
    &[[0.0107, 0.0072], [0.0035, 0.0024], [0.0048, 0.0033]],
    &[[0.0099, 0.0067], [0.0030, 0.0020], [0.0028, 0.0019]],
    &[[0.0436, 0.0296], [0.0152, 0.0103], [0.0169, 0.0115]],
];

/// q^off of Table 1, degrees: axes 2 and 3.
pub const TABLE_1_OFFSET: [(usize, f64); 2] = [(2, 7.5), (3, 25.0)];

/// The six axes.
pub fn axes() -> [Joint; 6] {
    TABLES.map(|[inertia, mx, my, vp, vm, cp, cm]| Joint {
        inertia,
        moments: (mx != 0.0).then_some([mx, my]),
        friction: Friction {
            viscous: [vp, vm],
            coulomb: [cp, cm],
        },
    })
}

/// What acts on an axis.
pub fn columns(joint: &Joint) -> Columns {
    Columns {
        gravity: joint.moments.is_some(),
    }
}
