//! `external_contact`: pushes. They have no columns: [`crate::traces::contact`] finds them in either recording.

use super::info::{Carried, Info};

/// Description of `external_contact`: remedy, rules.
pub(super) const INFO: Info = Info {
    name: "external_contact",
    plain: "contact",
    confounders: &[],
    remedy: "nothing: leave this part of the recording out ({})",
    outside: true,
    passing: true,
    unplanned: "it is found where and when it happens",
    carried: |_| Carried::Not,
    ..Info::NEW
};
