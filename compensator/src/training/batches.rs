//! Items of a batch: windows, or chunks of carried state.

use std::ops::Range;

use feedforward::network::{Architecture, Bounds, Memory, Normaliser, Recurrent};

use super::samples::Samples;
use crate::config::Training;
use crate::engine::{Network, Real, Span};

/// Row of a batch: one window or chunk of samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Item {
    /// Row of the newest sample of a window, or of the first sample of a chunk.
    row: u32,
    /// First row of its trajectory.
    start: u32,
    /// Row after the last one of its trajectory.
    end: u32,
}

/// Layout of samples as rows of a batch.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Layout {
    /// Windows of this many samples, one output each.
    Windows(usize),
    /// Chunks with an output per sample; the first `fill` samples of a chunk inside a trajectory only
    /// bring the state up.
    Chunks { length: usize, fill: usize },
}

impl Layout {
    /// Layout that an architecture needs: chunks for carried state, else windows.
    pub(super) fn new(architecture: &Architecture, training: &Training) -> Self {
        match architecture {
            Architecture::Recurrent(Recurrent {
                memory: Memory::Carried { .. },
                ..
            }) => Self::Chunks {
                length: training.chunk,
                fill: training.fill,
            },
            _ => Self::Windows(architecture.timestep()),
        }
    }

    /// Size of a pass over `batch` rows.
    pub(super) fn span(self, batch: usize) -> Span {
        match self {
            Self::Windows(steps) => Span {
                batch,
                steps,
                first: steps - 1,
            },
            Self::Chunks { length, .. } => Span {
                batch,
                steps: length,
                first: 0,
            },
        }
    }

    /// Items (rows of a batch) that cover every sample with weight in the given trajectories exactly once.
    pub(super) fn items(self, samples: &Samples, trajectories: &[usize]) -> Vec<Item> {
        let mut items = Vec::new();
        for &t in trajectories {
            let Range { start, end } = samples.trajectories()[t].clone();
            let mut push = |row: usize| {
                items.push(Item {
                    row: row as u32,
                    start: start as u32,
                    end: end as u32,
                })
            };
            match self {
                Self::Windows(_) => (start..end)
                    .filter(|&row| samples.weight(row) > 0.0)
                    .for_each(push),
                Self::Chunks { length, fill } => {
                    push(start);
                    (start + length - fill..)
                        .step_by(length - fill)
                        .take_while(|&row| row + fill < end)
                        .for_each(push);
                }
            }
        }
        items
    }

    /// Items with one window per sample of the given trajectories, those without weight included.
    pub(super) fn every_row(self, samples: &Samples, trajectories: &[usize]) -> Vec<Item> {
        let rows = |&t: &usize| {
            let Range { start, end } = samples.trajectories()[t].clone();
            (start..end).map(move |row| Item {
                row: row as u32,
                start: start as u32,
                end: end as u32,
            })
        };
        trajectories.iter().flat_map(rows).collect()
    }

    /// Row of step t; a window repeats the trajectory's first sample, a chunk its last.
    #[inline]
    fn row(self, item: Item, t: usize) -> usize {
        match self {
            Self::Windows(steps) => (item.row as usize + t + 1)
                .saturating_sub(steps)
                .max(item.start as usize),
            Self::Chunks { .. } => (item.row as usize + t).min(item.end as usize - 1),
        }
    }

    /// Row whose target belongs to output step `t`, and whether it counts.
    #[inline]
    fn scored(self, item: Item, t: usize) -> (usize, bool) {
        let row = self.row(item, t);
        let counts = match self {
            Self::Windows(_) => true,
            Self::Chunks { fill, .. } => {
                let inside = item.row as usize + t < item.end as usize;
                inside && (t >= fill || item.row == item.start)
            }
        };
        (row, counts)
    }
}

/// Source of batches: it gathers, normalises and limits inputs, and normalises targets.
#[derive(Debug)]
pub(super) struct Gatherer<'a, 'd> {
    /// Samples of the unit.
    pub(super) samples: Samples<'d>,
    /// Indices of the input columns.
    pub(super) columns: &'a [usize],
    /// Normalisation of the inputs.
    pub(super) input: &'a Normaliser,
    /// Normalisation of the target.
    pub(super) target: &'a Normaliser,
    /// Range of the training inputs, within which inputs are held.
    pub(super) bounds: &'a Bounds,
    /// Layout of samples as rows of a batch.
    pub(super) layout: Layout,
}

impl Gatherer<'_, '_> {
    /// Writes the inputs of the items into the network.
    pub(super) fn inputs<T: Real>(&self, items: &[Item], network: &mut Network<T>) {
        let mut raw = vec![0.0; self.columns.len()];
        for t in 0..self.layout.span(items.len()).steps {
            for (k, &item) in items.iter().enumerate() {
                self.samples
                    .gather(self.layout.row(item, t), self.columns, &mut raw);
                for (j, (x, &value)) in network.input_mut(t, k).iter_mut().zip(&raw).enumerate() {
                    *x = T::from_f32(self.bounds.hold(j, self.input.apply(j, value)));
                }
            }
        }
    }

    /// Row, normalised target and weight of every output, in the network's order.
    pub(super) fn targets<'b>(
        &'b self,
        items: &'b [Item],
    ) -> impl Iterator<Item = (usize, f32, f32)> + 'b {
        let span = self.layout.span(items.len());
        (span.first..span.steps).flat_map(move |t| {
            items.iter().map(move |&item| {
                let (row, counts) = self.layout.scored(item, t);
                let weight = if counts {
                    self.samples.weight(row)
                } else {
                    0.0
                };
                (row, self.target.apply(0, self.samples.target(row)), weight)
            })
        })
    }
}

#[cfg(test)]
mod tests {
    use ndarray::{Array1, Array2};
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn every_sample_counts_exactly_once(lengths in proptest::collection::vec(1_usize..90, 1..5), fill in 0_usize..12) {
            let mut trajectories = Vec::new();
            let mut rows = 0;
            for n in lengths {
                trajectories.push(rows..rows + n);
                rows += n;
            }
            let (inputs, target) = (Array2::zeros((rows, 1)), Array1::zeros(rows));
            let samples = Samples::new(inputs.view(), target.view(), None, &trajectories).unwrap();
            let all: Vec<usize> = (0..trajectories.len()).collect();
            for layout in [Layout::Windows(3), Layout::Chunks { length: 17, fill }] {
                let mut counts = vec![0; rows];
                for item in layout.items(&samples, &all) {
                    let span = layout.span(1);
                    for t in span.first..span.steps {
                        let (row, scored) = layout.scored(item, t);
                        counts[row] += usize::from(scored);
                    }
                }
                prop_assert!(counts.iter().all(|&c| c == 1), "{:?} {:?}", layout, counts);
            }
        }
    }

    #[test]
    fn windows_do_not_cross_a_break() {
        let item = Item {
            row: 11,
            start: 10,
            end: 20,
        };
        let layout = Layout::Windows(4);
        assert_eq!([0, 1, 2, 3].map(|t| layout.row(item, t)), [10, 10, 10, 11]);
    }
}
