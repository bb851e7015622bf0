//! Inertial parameters of one rigid body.

use nalgebra::{Matrix3, Matrix4, Vector3};

/// Number of standard inertial parameters of a link.
pub const PARAMETERS_PER_LINK: usize = 10;

/// Names of the standard parameters, in the order used everywhere.
pub const PARAMETER_NAMES: [&str; PARAMETERS_PER_LINK] = [
    "m", "mx", "my", "mz", "Ixx", "Ixy", "Iyy", "Ixz", "Iyz", "Izz",
];

/// Inertial parameters of a body in a frame: mass, first moment and inertia about the frame's
/// origin, all linear in the mass distribution.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Inertia {
    /// Mass m of the body, kg.
    pub mass: f64,
    /// First moment m·c (c: centre of mass in the frame), kg·m.
    pub first_moment: Vector3<f64>,
    /// Inertia about the frame's **origin**, not the centre of mass; symmetric, kg·m².
    pub about_origin: Matrix3<f64>,
}

impl Inertia {
    /// Inertia from mass (kg), centre of mass (m) and inertia about the centre of mass (kg·m²), the last two in
    /// the directions of the frame: I = I_c + m (cᵀc·1 − c cᵀ) (parallel axes).
    pub fn from_com(mass: f64, com: Vector3<f64>, about_com: Matrix3<f64>) -> Self {
        Self {
            mass,
            first_moment: com * mass,
            about_origin: about_com + steiner(&com) * mass,
        }
    }

    /// Inertia from the standard parameters `[m, m·cx, m·cy, m·cz, Ixx, Ixy, Iyy, Ixz, Iyz, Izz]`.
    pub fn from_parameters(p: &[f64; PARAMETERS_PER_LINK]) -> Self {
        let [m, hx, hy, hz, xx, xy, yy, xz, yz, zz] = *p;
        Self {
            mass: m,
            first_moment: Vector3::new(hx, hy, hz),
            about_origin: Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz),
        }
    }

    /// The standard parameters `[m, m·cx, m·cy, m·cz, Ixx, Ixy, Iyy, Ixz, Iyz, Izz]`.
    pub fn parameters(&self) -> [f64; PARAMETERS_PER_LINK] {
        let (h, i) = (&self.first_moment, &self.about_origin);
        [
            self.mass,
            h.x,
            h.y,
            h.z,
            i[(0, 0)],
            i[(0, 1)],
            i[(1, 1)],
            i[(0, 2)],
            i[(1, 2)],
            i[(2, 2)],
        ]
    }

    /// Centre of mass, m; the origin for a massless body.
    pub fn com(&self) -> Vector3<f64> {
        if self.mass == 0.0 {
            Vector3::zeros()
        } else {
            self.first_moment / self.mass
        }
    }

    /// Inertia about the centre of mass, kg·m².
    pub fn about_com(&self) -> Matrix3<f64> {
        self.about_origin - steiner(&self.com()) * self.mass
    }

    /// Principal moments about the centre of mass, kg·m², the least first.
    pub fn principal_moments(&self) -> [f64; 3] {
        let mut moments: [f64; 3] = self.about_com().symmetric_eigenvalues().into();
        moments.sort_by(f64::total_cmp);
        moments
    }

    /// Inertia of the same body in a frame in which this one has orientation `rotation` and origin `translation` (x' = R x + t).
    pub fn transformed(&self, rotation: &Matrix3<f64>, translation: &Vector3<f64>) -> Self {
        let h = rotation * self.first_moment;
        let i = rotation * self.about_origin * rotation.transpose();
        // (c + t) in place of c: the cross terms h·t survive beside m·t².
        let cross = 2.0 * h.dot(translation) * Matrix3::identity()
            - h * translation.transpose()
            - translation * h.transpose();
        Self {
            mass: self.mass,
            first_moment: h + translation * self.mass,
            about_origin: i + cross + steiner(translation) * self.mass,
        }
    }

    /// Inertial parameters of both bodies rigidly joined, in the same frame.
    pub fn plus(&self, other: &Self) -> Self {
        Self {
            mass: self.mass + other.mass,
            first_moment: self.first_moment + other.first_moment,
            about_origin: self.about_origin + other.about_origin,
        }
    }

    /// Pseudo-inertia J = [[Σ, h], [hᵀ, m]] with Σ = ½ tr(I)·1 − I (second moments of the mass
    /// distribution). A body with these parameters exists if and only if J ⪰ 0 (Wensing, Kim and
    /// Slotine, 2018, "Linear matrix inequalities for physically consistent inertial parameter
    /// identification").
    pub fn pseudo_inertia(&self) -> Matrix4<f64> {
        let sigma = Matrix3::identity() * (0.5 * self.about_origin.trace()) - self.about_origin;
        let mut j = Matrix4::zeros();
        j.fixed_view_mut::<3, 3>(0, 0).copy_from(&sigma);
        j.fixed_view_mut::<3, 1>(0, 3).copy_from(&self.first_moment);
        j.fixed_view_mut::<1, 3>(3, 0)
            .copy_from(&self.first_moment.transpose());
        j[(3, 3)] = self.mass;
        j
    }

    /// Inverse of [`Inertia::pseudo_inertia`]: I = tr(Σ)·1 − Σ.
    pub fn from_pseudo_inertia(j: &Matrix4<f64>) -> Self {
        let sigma: Matrix3<f64> = j.fixed_view::<3, 3>(0, 0).into_owned();
        Self {
            mass: j[(3, 3)],
            first_moment: j.fixed_view::<3, 1>(0, 3).into_owned(),
            about_origin: Matrix3::identity() * sigma.trace() - sigma,
        }
    }

    /// Whether a rigid body with these parameters exists: positive mass and J ⪰ −`tolerance`·‖J‖.
    pub fn is_consistent(&self, tolerance: f64) -> bool {
        let values = self.pseudo_inertia().symmetric_eigenvalues();
        self.mass > 0.0 && values.min() >= -tolerance * values.amax()
    }
}

/// cᵀc·1 − c cᵀ, the inertia of a unit point mass at c.
fn steiner(c: &Vector3<f64>) -> Matrix3<f64> {
    Matrix3::identity() * c.norm_squared() - c * c.transpose()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn body() -> Inertia {
        Inertia::from_com(
            3.0,
            Vector3::new(0.1, -0.2, 0.3),
            Matrix3::new(0.05, 0.01, 0.0, 0.01, 0.06, -0.005, 0.0, -0.005, 0.04),
        )
    }

    #[test]
    fn parallel_axes_by_hand() {
        // Ixx = 0.05 + 3 (0.2² + 0.3²), Ixy = 0.01 − 3·0.1·(−0.2)
        let p = body().parameters();
        assert!((p[4] - (0.05 + 3.0 * 0.13)).abs() < 1e-15);
        assert!((p[5] - (0.01 + 0.06)).abs() < 1e-15);
    }

    #[test]
    fn representations_agree() {
        let b = body();
        assert_eq!(Inertia::from_parameters(&b.parameters()), b);
        let back = Inertia::from_pseudo_inertia(&b.pseudo_inertia());
        assert!((back.about_origin - b.about_origin).amax() < 1e-15);
        assert!((b.com() - Vector3::new(0.1, -0.2, 0.3)).amax() < 1e-15);
    }

    #[test]
    fn moving_the_frame_moves_only_the_centre_of_mass() {
        let r = *nalgebra::Rotation3::from_euler_angles(0.3, -1.1, 2.0).matrix();
        let t = Vector3::new(0.4, 0.5, -0.6);
        let moved = body().transformed(&r, &t);
        assert!((moved.com() - (r * body().com() + t)).amax() < 1e-15);
        let expected = r * body().about_com() * r.transpose();
        assert!((moved.about_com() - expected).amax() < 1e-14);
    }

    #[test]
    fn consistency_is_the_triangle_inequality() {
        let point = |d: [f64; 3]| {
            Inertia::from_com(
                1.0,
                Vector3::zeros(),
                Matrix3::from_diagonal(&Vector3::from(d)),
            )
        };
        assert!(point([1.0, 1.0, 1.9]).is_consistent(1e-12));
        assert!(!point([1.0, 1.0, 2.1]).is_consistent(1e-12));
    }
}
