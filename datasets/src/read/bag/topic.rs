//! The messages of one topic, as columns on their own clock.

use super::message::Texts;
use super::plan::Plan;
use super::source::list;
use super::wanted::Want;
use crate::Problem;

/// Values taken of a topic so far.
#[derive(Debug)]
pub(super) struct Topic {
    pub name: String,
    pub kind: String,
    pub wants: Vec<Want>,
    /// Columns, one for each want; NaN where a message leaves out an optional value.
    pub columns: Vec<Vec<f64>>,
    /// Header stamps of the messages, ns; zero without a header.
    pub stamps: Vec<i64>,
    /// Times at which messages were logged, ns.
    pub logged: Vec<i64>,
    /// Number of messages, those of other joints included.
    pub messages: usize,
    /// Problem, with the number of the message (from 0) where it concerns one.
    pub refused: Option<(Problem, Option<usize>)>,
    order: Order,
}

/// Positions of the joints in the messages.
#[derive(Debug, Default)]
struct Order {
    /// Joint names of the last message.
    names: Texts,
    /// Element of the message's arrays for each joint; none for a joint that it leaves out.
    places: Vec<Option<usize>>,
    /// Every joint name in the messages so far.
    met: Vec<String>,
}

impl Topic {
    /// Topic without any message so far.
    pub fn new(name: String, kind: String, wants: Vec<Want>) -> Self {
        Self {
            columns: vec![Vec::new(); wants.len()],
            name,
            kind,
            wants,
            stamps: Vec::new(),
            logged: Vec::new(),
            messages: 0,
            refused: None,
            order: Order::default(),
        }
    }

    /// Number of messages whose values were kept.
    pub fn len(&self) -> usize {
        self.logged.len()
    }

    /// Problem of a topic whose messages never name a needed joint.
    pub fn nobody(&self, joints: &[String]) -> Problem {
        Problem::MissingJoint {
            missing: list(joints.iter().map(String::as_str)),
            present: list(self.order.met.iter().map(String::as_str)),
        }
    }

    /// Takes the values of one message, or remembers why not.
    pub fn take(
        &mut self,
        plan: &mut Plan,
        joints: &mut Option<Vec<String>>,
        dof: usize,
        logged: i64,
        message: &[u8],
    ) {
        if self.refused.is_some() {
            return;
        }
        let number = self.messages;
        self.messages += 1;
        let taken = plan
            .read(message)
            .map_err(|detail| Problem::Message {
                topic: self.name.clone(),
                detail,
            })
            .and_then(|()| self.values(plan, joints, dof));
        match taken {
            Ok(true) => {
                self.stamps.push(plan.stamp());
                self.logged.push(logged);
            }
            Ok(false) => {}
            Err(problem) => self.refused = Some((problem, Some(number))),
        }
    }

    /// Takes the values of the message that was read; false where it is of other joints.
    fn values(
        &mut self,
        plan: &Plan,
        joints: &mut Option<Vec<String>>,
        dof: usize,
    ) -> Result<bool, Problem> {
        let names = plan.names.map(|slot| &plan.values.texts[slot]);
        let named = names.is_some_and(|n| *n != Texts::default());
        if let (true, Some(names)) = (named, names) {
            if self.order.names != *names {
                self.order.learn(names, joints, dof)?;
            }
            let mut by_name = self.wants.iter().filter(|w| w.index.is_none());
            if let Some(lost) = by_name.find(|w| self.order.places[w.joint].is_none()) {
                if self.order.places.iter().all(Option::is_none) {
                    return Ok(false);
                }
                return Err(self.order.missing(joints, lost.joint, names));
            }
        }
        for (column, slot) in plan.slots.iter().enumerate() {
            let value = match slot {
                Some(slot) => self.value(column, &plan.values.numbers[*slot], named, dof)?,
                None => f64::NAN,
            };
            self.columns[column].push(value);
        }
        Ok(true)
    }

    fn value(&self, column: usize, array: &[f64], named: bool, dof: usize) -> Result<f64, Problem> {
        let want = &self.wants[column];
        if array.is_empty() && !want.needed {
            return Ok(f64::NAN);
        }
        if array.is_empty() {
            return Err(Problem::EmptyField(want.field.clone()));
        }
        let place = match want.index {
            Some(index) => Some(index),
            None if named => self.order.places[want.joint],
            None if array.len() == dof => Some(want.joint),
            // A topic or a field of its own for each joint.
            None if array.len() == 1 => Some(0),
            None => None,
        };
        let value = place.and_then(|place| array.get(place));
        value.copied().ok_or_else(|| Problem::Elements {
            field: want.field.clone(),
            found: array.len(),
            dof,
        })
    }
}

impl Order {
    /// Looks up the joints among the names of a message.
    fn learn(
        &mut self,
        names: &Texts,
        joints: &mut Option<Vec<String>>,
        dof: usize,
    ) -> Result<(), Problem> {
        let here: Vec<String> = names.iter().map(|n| n.into_owned()).collect();
        for name in &here {
            if !self.met.contains(name) {
                self.met.push(name.clone());
            }
        }
        if joints.is_none() && here.len() != dof {
            return Err(Problem::WrongDof {
                expected: dof,
                found: here.len(),
                columns: list(here.iter().map(String::as_str)).into(),
                model: None,
            });
        }
        let joints = joints.get_or_insert_with(|| here.clone());
        self.places = joints
            .iter()
            .map(|joint| here.iter().position(|name| name == joint))
            .collect();
        self.names = names.clone();
        Ok(())
    }

    fn missing(&self, joints: &Option<Vec<String>>, joint: usize, names: &Texts) -> Problem {
        let here: Vec<String> = names.iter().map(|n| n.into_owned()).collect();
        let known = joints.as_ref().and_then(|j| j.get(joint));
        Problem::MissingJoint {
            missing: known.cloned().unwrap_or_default(),
            present: list(here.iter().map(String::as_str)),
        }
    }
}
