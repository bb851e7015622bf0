//! Collects the values of a bag's messages that a recording needs, and chooses the topic of the positions.

use super::definition::{JOINT_STATE_TYPE, fields};
use super::plan::Plan;
use super::source::{Channel, Sink, list};
use super::topic::Topic;
use super::wanted::{Want, Wanted};
use crate::Problem;
use std::collections::{BTreeMap, HashMap};

/// The topic that is taken where several hold the robot's joints.
pub(super) const USUAL: &str = "/joint_states";

/// Takes the wanted columns out of the messages.
#[derive(Debug)]
pub(super) struct Collector {
    wanted: Wanted,
    joints: Option<Vec<String>>,
    /// Type by topic, of all there are.
    present: BTreeMap<String, String>,
    topics: Vec<Topic>,
    channels: HashMap<u64, Reading>,
}

/// Topic and decoding plan of a channel of the present file.
#[derive(Debug)]
struct Reading {
    topic: usize,
    plan: Plan,
}

/// Content of a recording from a bag.
#[derive(Debug)]
pub(super) struct Collected {
    /// The topic of the positions first.
    pub topics: Vec<Topic>,
    /// Notes on the bag for the user.
    pub notes: Vec<String>,
}

/// A refusal, with the number of the message (from 0) where it concerns one.
pub(super) type Refusal = (Problem, Option<usize>);

impl Collector {
    /// Starts with nothing collected.
    pub fn new(wanted: Wanted) -> Self {
        Self {
            joints: wanted.joints.clone(),
            wanted,
            present: BTreeMap::new(),
            topics: Vec::new(),
            channels: HashMap::new(),
        }
    }

    /// Columns wanted of a topic.
    fn wants(&self, topic: &str, kind: &str) -> Vec<Want> {
        let base = match self.wanted.base() {
            Some(base) => base == topic,
            None => kind == JOINT_STATE_TYPE,
        };
        let of_it = |want: &&Want| match &want.topic {
            Some(own) => own == topic,
            None => base,
        };
        self.wanted.columns.iter().filter(of_it).cloned().collect()
    }

    fn topic(&mut self, channel: &Channel, wants: Vec<Want>) -> usize {
        let known = self.topics.iter().position(|t| t.name == channel.topic);
        known.unwrap_or_else(|| {
            let topic = Topic::new(channel.topic.clone(), channel.kind.clone(), wants);
            self.topics.push(topic);
            self.topics.len() - 1
        })
    }

    /// Returns the collected columns.
    ///
    /// # Errors
    /// A topic is missing, or its messages cannot be used.
    pub fn finish(mut self) -> Result<Collected, Refusal> {
        if self.present.is_empty() {
            return Err((Problem::Empty, None));
        }
        let base = self.base()?;
        let mut topics = vec![self.topics.swap_remove(base)];
        for want in &self.wanted.columns {
            let Some(name) = &want.topic else { continue };
            if topics.iter().any(|t| t.name == *name) {
                continue;
            }
            let at = self.topics.iter().position(|t| t.name == *name);
            let at = at.ok_or_else(|| (self.missing(name), None))?;
            topics.push(self.topics.swap_remove(at));
        }
        for topic in &mut topics {
            if let Some(refusal) = topic.refused.take() {
                return Err(refusal);
            }
            if topic.len() == 0 {
                return Err((self.nothing(topic), None));
            }
        }
        let mut notes = Vec::new();
        if let (None, Some(joints)) = (&self.wanted.joints, &self.joints) {
            notes.push(format!(
                "the joints are in the order of the first message: {}",
                joints.join(", ")
            ));
        }
        Ok(Collected { topics, notes })
    }

    fn nothing(&self, topic: &Topic) -> Problem {
        match &self.joints {
            Some(joints) if topic.messages > 0 => topic.nobody(joints),
            _ => Problem::Empty,
        }
    }

    fn missing(&self, topic: &str) -> Problem {
        Problem::MissingTopic {
            missing: topic.to_owned(),
            present: self.listed(),
        }
    }

    fn listed(&self) -> String {
        let one = |(topic, kind): (&String, &String)| format!("{topic} ({kind})");
        let all: Vec<String> = self.present.iter().map(one).collect();
        list(all.iter().map(String::as_str))
    }

    /// The topic of the positions.
    fn base(&self) -> Result<usize, Refusal> {
        if let Some(name) = self.wanted.base() {
            let at = self.topics.iter().position(|t| t.name == name);
            return at.ok_or_else(|| (self.missing(name), None));
        }
        let states: Vec<usize> = (0..self.topics.len())
            .filter(|&t| self.topics[t].kind == JOINT_STATE_TYPE)
            .collect();
        let usable: Vec<usize> = states
            .iter()
            .copied()
            .filter(|&t| self.topics[t].refused.is_none() && self.topics[t].len() > 0)
            .collect();
        // Where none can be used, the first says why.
        let choice = if usable.is_empty() { &states } else { &usable };
        let usual = choice.iter().find(|&&t| self.topics[t].name == USUAL);
        match (usual, choice.as_slice()) {
            (Some(&usual), _) => Ok(usual),
            (None, []) => Err((Problem::NoJointStates(self.listed()), None)),
            (None, [only]) => Ok(*only),
            (None, [first, ..]) if usable.is_empty() => Ok(*first),
            (None, several) => {
                let names = several.iter().map(|&t| self.topics[t].name.as_str());
                Err((Problem::SeveralTopics(list(names)), None))
            }
        }
    }
}

impl Sink for Collector {
    fn file(&mut self) {
        self.channels.clear();
    }

    fn channel(&mut self, channel: Channel) -> Result<(), Problem> {
        self.present
            .insert(channel.topic.clone(), channel.kind.clone());
        let wants = self.wants(&channel.topic, &channel.kind);
        if wants.is_empty() || self.channels.contains_key(&channel.id) {
            return Ok(());
        }
        let topic = self.topic(&channel, wants);
        let plan = plan(&channel, &self.topics[topic].wants, &self.wanted);
        match plan {
            Ok(plan) => {
                self.channels.insert(channel.id, Reading { topic, plan });
            }
            Err(problem) => {
                self.topics[topic].refused.get_or_insert((problem, None));
            }
        }
        Ok(())
    }

    fn message(&mut self, channel: u64, logged: i64, data: &[u8]) -> Result<(), Problem> {
        if let Some(reading) = self.channels.get_mut(&channel) {
            let topic = &mut self.topics[reading.topic];
            let dof = self.wanted.dof;
            topic.take(&mut reading.plan, &mut self.joints, dof, logged, data);
        }
        Ok(())
    }
}

fn plan(channel: &Channel, wants: &[Want], wanted: &Wanted) -> Result<Plan, Problem> {
    let unreadable = |reason: String| Problem::MessageType {
        topic: channel.topic.as_str().into(),
        kind: channel.kind.as_str().into(),
        reason: reason.into(),
    };
    if channel.encoding != "cdr" {
        return Err(unreadable(format!(
            "its messages are encoded as `{}`, not as `cdr`",
            channel.encoding
        )));
    }
    let fields = fields(&channel.kind, &channel.definition).map_err(unreadable)?;
    Plan::new(fields, wants, wanted)
}
