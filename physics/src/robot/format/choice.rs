//! Choice of the joints that make the robot, whatever the format: those that are asked for, those that carry a
//! frame, or the only chain.

use crate::robot::RobotError;

/// A joint of a description.
pub(super) struct Candidate<'a> {
    pub name: &'a str,
    /// Index of the nearest joint, of any kind, that carries this joint.
    pub above: Option<usize>,
    /// Whether the joint turns about or slides along one axis.
    pub scalar: bool,
    /// Whether a drive may move the joint: an actuator names it, or nothing makes it follow another.
    pub driven: bool,
    /// Whether another joint is tied to this one, as leader or follower.
    pub coupled: bool,
}

/// The joints of a description, every one after those that carry it.
pub(super) struct Tree<'a> {
    pub joints: Vec<Candidate<'a>>,
    /// Bodies by name with the joint that carries each.
    pub frames: Vec<(&'a str, Option<usize>)>,
}

/// Choice of the user: names of joints, base first, or of one frame, and joints held at another position than their reference.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Wanted {
    pub names: Vec<String>,
    /// Joints with their positions, rad or m.
    pub held: Vec<(String, f64)>,
}

impl Wanted {
    /// Reads `a`, `b`, `finger=0.02`.
    pub fn read(joints: &[String]) -> Result<Self, RobotError> {
        let mut wanted = Self::default();
        for word in joints {
            match word.split_once('=') {
                None => wanted.names.push(word.clone()),
                Some((name, value)) => {
                    let position = value.trim().parse().ok().filter(|v: &f64| v.is_finite());
                    let position = position.ok_or_else(|| {
                        refused(format!(
                            "{word:?} gives joint {name:?} no position; write {name}=0.5 in rad or m"
                        ))
                    })?;
                    wanted.held.push((name.trim().to_owned(), position));
                }
            }
        }
        Ok(wanted)
    }
}

/// Refusal of a choice of joints, with the remedy.
pub(super) fn refused(reason: impl Into<String>) -> RobotError {
    RobotError::Joints {
        reason: reason.into(),
    }
}

impl Tree<'_> {
    /// Indices of the chosen joints, base first, on one way from the base outwards.
    pub fn choose(&self, wanted: &Wanted) -> Result<Vec<usize>, RobotError> {
        let chosen = match &wanted.names[..] {
            [] => self.one_chain()?,
            [one] if self.named(one).is_none() => match self.carrying(one) {
                Some(chain) => chain?,
                None => return Err(self.unknown(one)),
            },
            names => self.of_names(names)?,
        };
        for pair in chosen.windows(2) {
            if !self.carries(pair[0], pair[1]) {
                return Err(refused(format!(
                    "joints {:?} and {:?} do not lie on one chain, and a tree of moving arms is not supported; choose joints \
                     of one arm by --joints, base first",
                    self.joints[pair[0]].name, self.joints[pair[1]].name
                )));
            }
        }
        for (name, _) in &wanted.held {
            match self.named(name) {
                None => return Err(self.unknown(name)),
                Some(j) if chosen.contains(&j) => {
                    return Err(refused(format!(
                        "joint {name:?} is one of the robot's and cannot stand still; leave its position out"
                    )));
                }
                Some(_) => {}
            }
        }
        Ok(chosen)
    }

    /// Chains that may be meant, by names: to every end, and to where each spreads.
    pub fn chains(&self) -> Vec<Vec<String>> {
        let all = self.candidates();
        let mut chains = Vec::new();
        for &end in &all {
            let below = all
                .iter()
                .filter(|&&k| self.next_above(k, &all) == Some(end));
            if below.count() == 1 {
                continue;
            }
            let mut chain = vec![end];
            while let Some(above) = self.next_above(chain[chain.len() - 1], &all) {
                chain.push(above);
            }
            chain.reverse();
            chains.push(
                chain
                    .iter()
                    .map(|&j| self.joints[j].name.to_owned())
                    .collect(),
            );
        }
        chains
    }

    fn named(&self, name: &str) -> Option<usize> {
        self.joints.iter().position(|j| j.name == name)
    }

    /// Whether a joint carries another.
    fn carries(&self, joint: usize, other: usize) -> bool {
        let mut at = Some(other);
        while let Some(j) = at.filter(|&j| j > joint) {
            at = self.joints[j].above;
        }
        at == Some(joint)
    }

    /// The nearest of some joints that carries a joint.
    fn next_above(&self, joint: usize, some: &[usize]) -> Option<usize> {
        let mut at = self.joints[joint].above;
        while let Some(j) = at.filter(|j| some.binary_search(j).is_err()) {
            at = self.joints[j].above;
        }
        at
    }

    /// The driven joints that carry a frame.
    fn carrying(&self, frame: &str) -> Option<Result<Vec<usize>, RobotError>> {
        let (_, last) = self.frames.iter().find(|(name, _)| *name == frame)?;
        let mut at = *last;
        let mut chain = Vec::new();
        while let Some(j) = at {
            let joint = &self.joints[j];
            if joint.scalar && joint.driven {
                chain.push(j);
            }
            at = joint.above;
        }
        chain.reverse();
        let empty = chain.is_empty();
        let none = || refused(format!("no joint moves {frame:?}; give a frame that moves"));
        Some(if empty { Err(none()) } else { Ok(chain) })
    }

    fn unknown(&self, name: &str) -> RobotError {
        refused(format!(
            "there is no joint {name:?}, and no body of this name; the joints that turn or slide are {}",
            self.list(&self.scalar())
        ))
    }

    fn of_names(&self, names: &[String]) -> Result<Vec<usize>, RobotError> {
        let mut chosen = Vec::new();
        for name in names {
            let Some(joint) = self.named(name) else {
                return Err(self.unknown(name));
            };
            if !self.joints[joint].scalar {
                return Err(refused(format!(
                    "joint {name:?} does not turn about or slide along one axis (it is a ball or free joint, planar, floating or \
                     fixed); choose others"
                )));
            }
            if chosen.contains(&joint) {
                return Err(refused(format!("joint {name:?} is chosen twice")));
            }
            chosen.push(joint);
        }
        let mut order = chosen.clone();
        order.sort_unstable();
        if order != chosen {
            return Err(refused(format!(
                "the chosen joints are not in the order of the chain; give --joints {}",
                self.list(&order).replace(", ", ",")
            )));
        }
        Ok(chosen)
    }

    fn scalar(&self) -> Vec<usize> {
        let joints = self.joints.iter().enumerate();
        joints.filter(|(_, j)| j.scalar).map(|(i, _)| i).collect()
    }

    /// The driven joints, or all where none is driven.
    fn candidates(&self) -> Vec<usize> {
        let mut all = self.scalar();
        if all.iter().any(|&j| self.joints[j].driven) {
            all.retain(|&j| self.joints[j].driven);
        }
        all
    }

    fn list(&self, joints: &[usize]) -> String {
        let names = joints.iter().map(|&j| self.joints[j].name);
        names.collect::<Vec<_>>().join(", ")
    }

    /// The chain of driven joints (of all joints where none is driven) from the base to where it ends or spreads into the
    /// fingers of a hand.
    fn one_chain(&self) -> Result<Vec<usize>, RobotError> {
        let candidates = self.candidates();
        let parents: Vec<Option<usize>> = candidates
            .iter()
            .map(|&j| self.next_above(j, &candidates))
            .collect();
        let below = |joint: Option<usize>| -> Vec<usize> {
            let pairs = candidates.iter().zip(&parents);
            pairs
                .filter(|(_, p)| **p == joint)
                .map(|(j, _)| *j)
                .collect()
        };
        // Longest way outwards from each candidate; children come after their parents.
        let mut longest = vec![1; candidates.len()];
        for i in (0..candidates.len()).rev() {
            if let Some(parent) = parents[i]
                && let Ok(at) = candidates.binary_search(&parent)
            {
                longest[at] = longest[at].max(longest[i] + 1);
            }
        }
        let reach = |joint: &usize| candidates.binary_search(joint).map_or(0, |at| longest[at]);
        let mut chain: Vec<usize> = Vec::new();
        loop {
            match below(chain.last().copied())[..] {
                [] => break,
                [only] => chain.push(only),
                ref several => {
                    // The fingers of a hand are no longer than the arm; two arms on a column are.
                    let branch = several.iter().map(reach).max().unwrap_or(0);
                    if chain.len() > branch {
                        break;
                    }
                    return Err(RobotError::SeveralChains {
                        starts: self.list(several),
                    });
                }
            }
        }
        // A finger that drives others is no joint of the arm.
        while chain.len() > 1 && chain.last().is_some_and(|&j| self.joints[j].coupled) {
            chain.pop();
        }
        Ok(chain)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Joints by name, what carries each, and whether it follows another.
    fn tree<'a>(joints: &[(&'a str, Option<usize>, bool)]) -> Tree<'a> {
        let candidate = |&(name, above, follows): &(&'a str, Option<usize>, bool)| Candidate {
            name,
            above,
            scalar: true,
            driven: !follows,
            coupled: false,
        };
        Tree {
            joints: joints.iter().map(candidate).collect(),
            frames: vec![("tool", Some(joints.len() - 1))],
        }
    }

    fn names(tree: &Tree<'_>, wanted: &[&str]) -> Result<String, String> {
        let wanted: Vec<String> = wanted.iter().map(|&w| w.to_owned()).collect();
        let chosen = Wanted::read(&wanted).and_then(|w| tree.choose(&w));
        chosen.map(|c| tree.list(&c)).map_err(|e| e.to_string())
    }

    #[test]
    fn a_chain_ends_where_it_spreads_into_fingers() {
        let hand = tree(&[
            ("a", None, false),
            ("b", Some(0), false),
            ("left", Some(1), false),
            ("right", Some(1), true),
            ("other", Some(1), false),
        ]);
        assert_eq!(names(&hand, &[]).unwrap(), "a, b");
        assert_eq!(names(&hand, &["left=0.1"]).unwrap(), "a, b");
        assert_eq!(names(&hand, &["a", "b", "left"]).unwrap(), "a, b, left");
        assert_eq!(names(&hand, &["tool"]).unwrap(), "a, b, other");
        for (wanted, expected) in [
            (&["left", "other"][..], "do not lie on one chain"),
            (&["b", "a"], "give --joints a,b"),
            (&["a=1", "a"], "cannot stand still"),
            (&["a=x"], "no position"),
            (&["x"], "no joint \"x\""),
        ] {
            let error = names(&hand, wanted).expect_err(expected);
            assert!(error.contains(expected), "{error}");
        }
    }

    #[test]
    fn what_follows_others_makes_no_branch() {
        let rod = tree(&[
            ("a", None, false),
            ("rod", Some(0), true),
            ("b", Some(0), false),
            ("c", Some(2), false),
        ]);
        assert_eq!(names(&rod, &[]).unwrap(), "a, b, c");
    }

    #[test]
    fn two_arms_are_asked_about() {
        let arms = tree(&[
            ("torso", None, false),
            ("l1", Some(0), false),
            ("l2", Some(1), false),
            ("r1", Some(0), false),
            ("r2", Some(3), false),
        ]);
        let error = names(&arms, &[]).expect_err("two arms");
        assert!(error.contains("begin at l1, r1"), "{error}");
        let chains: Vec<String> = arms.chains().iter().map(|c| c.join(" ")).collect();
        assert_eq!(chains, ["torso", "torso l1 l2", "torso r1 r2"]);
    }
}
