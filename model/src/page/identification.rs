//! Section on the identified parameters and their quality.

use crate::directory::ModelFile;
use crate::tables;
use report::Section;

pub(super) fn section(file: &ModelFile) -> Section {
    let mut section = Section::new("Identified parameters");
    if let Some(d) = &file.diagnostics {
        section = section.list(tables::estimator(file, d));
    }
    section = section.table(
        tables::terms(file).caption("Friction and memory per joint; ± one standard deviation"),
    );
    section = section.details(
        Section::new("Base parameters, with the standard parameters that form each")
            .table(tables::base_parameters(file)),
    );
    if let (Some(table), Some(hz)) = (tables::cutoffs(file), file.preprocessing.cutoff_hz) {
        section = section.details(
            Section::new(format!("Cut-off of the motion: {hz:.2} Hz, of those tried"))
                .paragraph("Rigid body, viscous and softened Coulomb friction, offset and rotor inertia, fitted to the recorded torque of the training recordings; the error is that on rows left out. The middle of the stretch that is as good as the best is taken.")
                .table(table),
        );
    }
    let Some(d) = &file.diagnostics else {
        return section;
    };
    section = section.details(
        Section::new("Condition numbers of the weighted regressor")
            .table(tables::conditioning(&d.conditioning)),
    );
    if !d.links.is_empty() {
        section = section.details(
            Section::new("Feasibility of the links in the identified URDF")
                .paragraph("Eigenvalues of each link's 4 × 4 pseudo-inertia over the largest one. All are positive where a body with this mass, centre and inertia can exist.")
                .table(tables::links(d)),
        );
    }
    section.details(
        Section::new("Tests of the residual on the training recordings")
            .table(tables::residual_tests(&file.joints, &d.residual_tests)),
    )
}
