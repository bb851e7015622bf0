//! Whether the identified inertia matrix is positive definite.

use feedforward::Feedforward;
use model::physics_fit::Fit;
use nalgebra::DMatrix;
use std::path::Path;

/// Most poses of the recordings that are looked at.
const POSES: usize = 100;

/// Line that warns of an inertia matrix with an eigenvalue of at most zero in a recorded pose. The torque along recorded motion needs no
/// positive one, and plain estimators do not keep it so; forward dynamics and impedance control do. None where all are positive, and
/// for a model that cannot be read again.
pub fn impossible(directory: &Path, fit: &Fit) -> Option<String> {
    let mut model = Feedforward::load_physics(directory, None).ok()?;
    let names = model.dynamics().robot().joint_names();
    let n = names.len();
    let mut m = vec![0.0; n * n];
    let mut worst: Option<(f64, usize)> = None;
    for part in &fit.session.parts[..fit.file.provenance.recordings.len()] {
        let q = &part.at_samples.q;
        for row in q
            .rows()
            .into_iter()
            .step_by(q.nrows().div_ceil(POSES).max(1))
        {
            model.dynamics().mass_matrix(&row.to_vec(), &mut m);
            let own = DMatrix::from_row_slice(n, n, &m).symmetric_eigen();
            let (at, least) = own.eigenvalues.argmin();
            if least <= 0.0 && worst.is_none_or(|(before, _)| least < before) {
                worst = Some((least, own.eigenvectors.column(at).iamax()));
            }
        }
    }
    let (least, joint) = worst?;
    Some(format!(
        "{}: the identified inertia matrix is not positive definite in recorded poses (an eigenvalue of {least:.2e} kg·m²). The torque is not \
         worse for it; for forward dynamics, impedance control or computed torque train with --lmi last.",
        names[joint]
    ))
}
