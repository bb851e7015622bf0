//! Parameters of the given structure that moved, with all causes in the fit, and by how many standard deviations.

use crate::schema::Moved;
use crate::search::find::Findings;
use crate::simulator::NominalModel;
use physics::robot::{PARAMETER_NAMES, PARAMETERS_PER_LINK};

/// Parameters that moved clearly, most deviations first. A payload does not count as a change of the last link.
pub fn moved(model: &NominalModel, found: &Findings) -> Vec<Moved> {
    let n = model.robot.dof();
    let said = &found.settings.measure.said;
    let inertial = PARAMETERS_PER_LINK * n;
    let joints = model.robot.joints();
    let mut given = model.robot.parameters();
    given.extend(joints.iter().map(|j| j.damping));
    given.extend(joints.iter().map(|j| j.friction));
    let mut out = Vec::new();
    let changes = found.changes(|i| !found.is_structure(i));
    for (column, (&before, (change, std))) in given.iter().zip(changes).enumerate() {
        let deviations = change.abs() / std.max(1e-300);
        if !(deviations.is_finite() && deviations > said.moved) {
            continue;
        }
        let turns = |j: usize| joints[j].kind.is_rotation();
        let (name, j, unit) = if column < inertial {
            let (j, p) = (column / PARAMETERS_PER_LINK, column % PARAMETERS_PER_LINK);
            let unit = ["kg", "kg·m", "kg·m²"][[0, 1, 1, 1, 2, 2, 2, 2, 2, 2][p]];
            (PARAMETER_NAMES[p], j, unit)
        } else if column < inertial + n {
            let j = column - inertial;
            let unit = if turns(j) { "N·m·s/rad" } else { "N·s/m" };
            ("viscous", j, unit)
        } else {
            let j = column - inertial - n;
            let unit = if turns(j) { "N·m" } else { "N" };
            ("coulomb", j, unit)
        };
        out.push(Moved {
            name: name.to_owned(),
            joint: joints[j].name.clone(),
            given: before,
            value: before + change,
            std,
            unit,
            deviations,
        });
    }
    out.sort_by(|a, b| b.deviations.total_cmp(&a.deviations));
    out.truncate(said.most_moved);
    out
}
