//! Failure message where no motion can be designed.

use identify::excitation::ExcitationError;
use model::failure::Failure;

/// Failure with the joint's name in one line, and advice.
pub fn of(error: &ExcitationError, names: &[String]) -> Failure {
    let hint = match error {
        ExcitationError::NoRoom { .. } => {
            "Give --position, --velocity, --acceleration or --limits.".to_owned()
        }
        ExcitationError::TooSlow { enough, .. } => format!(
            "Give --period {:.1} or more, a higher limit, or a smaller range by --position.",
            (enough * 10.0).ceil() / 10.0
        ),
        ExcitationError::FewCycles { needed, .. } => {
            format!(
                "Give --period {:.0} or more, or leave it out.",
                needed.ceil()
            )
        }
        ExcitationError::Commensurate { .. } => {
            "Give --velocity one value per joint, so that they differ.".to_owned()
        }
        ExcitationError::HomeOutside { .. } => "Give another --home, or --share 1.".to_owned(),
        ExcitationError::ToolOutsideAtHome { .. } => {
            "Give another --home, or a larger region.".to_owned()
        }
        ExcitationError::ToolNowhere | ExcitationError::NothingFound => {
            "Give a larger region, and look at --tool and the units: m, in the base frame."
                .to_owned()
        }
        ExcitationError::FewHarmonics { .. } => {
            "Give more --harmonics, or --rest velocity.".to_owned()
        }
        ExcitationError::Empty(_) | ExcitationError::LeastSquares(_) => String::new(),
    };
    let mut message = error.to_string();
    let joint = match error {
        ExcitationError::NoRoom { joint }
        | ExcitationError::TooSlow { joint, .. }
        | ExcitationError::FewCycles { joint, .. }
        | ExcitationError::Commensurate { joint }
        | ExcitationError::HomeOutside { joint, .. } => names.get(*joint).map(|n| (*joint, n)),
        _ => None,
    };
    if let Some((joint, name)) = joint {
        // The library counts; a person has names.
        message = message.replacen(&format!("joint {}", joint + 1), name, 1);
    }
    Failure::input(message, hint)
}
