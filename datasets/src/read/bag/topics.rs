//! Summary of a bag, topic by topic.

use super::definition::{JOINT_STATE_TYPE, fields};
use super::message::Texts;
use super::plan::{Plan, describe};
use super::source::{Channel, Sink};
use super::wanted::Wanted;
use crate::{Problem, ReadOptions};
use std::collections::HashMap;

/// Summary of one topic of a bag.
#[derive(Clone, Debug, PartialEq)]
pub struct TopicSummary {
    /// Name of the topic in the bag.
    pub topic: String,
    /// Type of its messages, as `package/Name`.
    pub kind: String,
    /// Number of messages of the topic.
    pub messages: usize,
    /// Messages per second between the first and the last by the clock of the log; `None` of fewer than two.
    pub rate_hz: Option<f64>,
    /// Names that the messages give joints, in the order of their first appearance.
    pub joints: Vec<String>,
    /// Fields that hold numbers or texts, arrays with brackets; empty where the messages cannot be read.
    pub fields: Vec<String>,
    /// Reason why the messages cannot be read.
    pub unreadable: Option<String>,
}

/// Collects the summaries of the topics.
#[derive(Default)]
pub(super) struct Listing {
    topics: Vec<Seen>,
    channels: HashMap<u64, (usize, Option<Plan>)>,
}

struct Seen {
    summary: TopicSummary,
    first: i64,
    last: i64,
    names: Texts,
}

impl Listing {
    /// The topics in the order of their first channel.
    pub fn finish(self) -> Vec<TopicSummary> {
        let summary = |seen: Seen| {
            let seconds = seen.last.saturating_sub(seen.first) as f64 * 1e-9;
            let steps = seen.summary.messages.saturating_sub(1) as f64;
            TopicSummary {
                rate_hz: (steps > 0.0 && seconds > 0.0).then(|| steps / seconds),
                ..seen.summary
            }
        };
        self.topics.into_iter().map(summary).collect()
    }

    /// Joint names of the topic of joint states; of several, `/joint_states` goes first. `None` without such a topic.
    pub fn joints(self) -> Option<Vec<String>> {
        let states = |s: &Seen| s.summary.kind == JOINT_STATE_TYPE && s.summary.messages > 0;
        let mut found: Vec<TopicSummary> = self
            .topics
            .into_iter()
            .filter(states)
            .map(|s| s.summary)
            .collect();
        found.sort_by_key(|s| s.topic != super::collect::USUAL);
        found.into_iter().next().map(|s| s.joints)
    }

    fn topic(&mut self, channel: &Channel) -> usize {
        let known = self
            .topics
            .iter()
            .position(|s| s.summary.topic == channel.topic);
        known.unwrap_or_else(|| {
            self.topics.push(Seen {
                summary: TopicSummary {
                    topic: channel.topic.clone(),
                    kind: channel.kind.clone(),
                    messages: 0,
                    rate_hz: None,
                    joints: Vec::new(),
                    fields: Vec::new(),
                    unreadable: None,
                },
                first: i64::MAX,
                last: i64::MIN,
                names: Texts::default(),
            });
            self.topics.len() - 1
        })
    }
}

impl Sink for Listing {
    fn file(&mut self) {
        self.channels.clear();
    }

    fn channel(&mut self, channel: Channel) -> Result<(), Problem> {
        if self.channels.contains_key(&channel.id) {
            return Ok(());
        }
        let topic = self.topic(&channel);
        let summary = &mut self.topics[topic].summary;
        let plan = match fields(&channel.kind, &channel.definition) {
            _ if channel.encoding != "cdr" => {
                summary.unreadable = Some(format!(
                    "its messages are encoded as `{}`",
                    channel.encoding
                ));
                None
            }
            Ok(fields) => {
                summary.fields.clear();
                describe(&fields, "", &mut summary.fields);
                Plan::new(fields, &[], &Wanted::new(&ReadOptions::default(), 0, None)).ok()
            }
            Err(reason) => {
                summary.unreadable = Some(reason);
                None
            }
        };
        // Only names are looked at.
        let plan = plan.filter(|p| p.names.is_some());
        self.channels.insert(channel.id, (topic, plan));
        Ok(())
    }

    fn message(&mut self, channel: u64, logged: i64, data: &[u8]) -> Result<(), Problem> {
        let Some((topic, plan)) = self.channels.get_mut(&channel) else {
            return Ok(());
        };
        let seen = &mut self.topics[*topic];
        seen.summary.messages += 1;
        seen.first = seen.first.min(logged);
        seen.last = seen.last.max(logged);
        let Some(plan) = plan else { return Ok(()) };
        if let Err(reason) = plan.read(data) {
            seen.summary.unreadable = Some(format!("a message {reason}"));
            return Ok(());
        }
        let names = plan.names.map(|slot| &plan.values.texts[slot]);
        if let Some(names) = names.filter(|n| **n != seen.names) {
            for name in names.iter() {
                if !seen.summary.joints.iter().any(|j| *j == name) {
                    seen.summary.joints.push(name.into_owned());
                }
            }
            seen.names = names.clone();
        }
        Ok(())
    }
}
