//! What the networks of a compensator remember, side by side in the columns of two tensors.

use feedforward::network::{Architecture, Compensator, Memory, Recurrent, Unit};

use super::graph::{CELL, Graph, HIDDEN, NEXT_CELL, NEXT_HIDDEN};

/// Columns of the hidden state `h` and of the cell state `c` in [`super::export_steps`]'s graph, at least one.
///
/// A unit that carries its state has its layers' states in `h` and their cells in the same columns of `c`. A unit on a window has
/// the samples before the newest one in `h`.
pub fn hidden_size(compensator: &Compensator) -> usize {
    let on = compensator.units.iter().filter(|unit| unit.enabled);
    on.map(width).sum::<usize>().max(1)
}

/// Columns that a unit takes.
fn width(unit: &Unit) -> usize {
    match &unit.architecture {
        Architecture::Recurrent(
            shape @ Recurrent {
                memory: Memory::Carried { .. },
                ..
            },
        ) => {
            let before = earlier(shape);
            let older = before.saturating_sub(1) * shape.encoder;
            unit.members.len() * (shape.encoder + older + before + shape.reencoder)
        }
        windowed => match windowed.timestep() {
            1 => 0,
            samples => (samples - 1) * unit.columns.len() + 1,
        },
    }
}

/// Earlier states that the attention of a network with carried state sees beside the newest one.
pub(super) fn earlier(shape: &Recurrent) -> usize {
    match (shape.attention, shape.memory) {
        (Some(_), Memory::Carried { attended }) => attended - 1,
        _ => 0,
    }
}

/// Columns of `h` and `c` that hold one value.
#[derive(Clone, Copy)]
pub(super) struct Place {
    /// First column.
    start: usize,
    /// Number of columns.
    width: usize,
}

/// Both tensors (1 × batch × `width`): what is read from them, and what will stand in them after the step.
pub(super) struct State {
    /// Number of columns.
    width: usize,
    /// Columns that are given out.
    taken: usize,
    /// Values of `h` after the step, each in its columns and zero elsewhere.
    hidden: Vec<String>,
    /// The same of `c`.
    cell: Vec<String>,
}

impl State {
    pub(super) fn new(compensator: &Compensator) -> Self {
        Self {
            width: hidden_size(compensator),
            taken: 0,
            hidden: Vec::new(),
            cell: Vec::new(),
        }
    }

    /// The next free columns.
    pub(super) fn take(&mut self, width: usize) -> Place {
        let start = self.taken;
        self.taken += width;
        Place { start, width }
    }

    /// Name of the value that `h` holds in a place.
    pub(super) fn hidden(&self, g: &mut Graph, place: Place) -> String {
        self.read(g, HIDDEN, place)
    }

    /// Name of the first column of the value that `h` holds in a place, `times` side by side.
    pub(super) fn repeated(&self, g: &mut Graph, place: Place, times: usize) -> String {
        g.pick(HIDDEN, self.width, &vec![place.start; times])
    }

    /// Name of the value that `c` holds in a place.
    pub(super) fn cell(&self, g: &mut Graph, place: Place) -> String {
        self.read(g, CELL, place)
    }

    fn read(&self, g: &mut Graph, from: &str, place: Place) -> String {
        let columns: Vec<usize> = (place.start..place.start + place.width).collect();
        g.pick(from, self.width, &columns)
    }

    /// Puts a value into `h` for the next step.
    pub(super) fn keep_hidden(&mut self, g: &mut Graph, value: &str, place: Place) {
        let placed = g.place(value, place.width, place.start, self.width);
        self.hidden.push(placed);
    }

    /// Puts a value into `c` for the next step.
    pub(super) fn keep_cell(&mut self, g: &mut Graph, value: &str, place: Place) {
        let placed = g.place(value, place.width, place.start, self.width);
        self.cell.push(placed);
    }

    /// Makes both tensors after the step outputs of the graph.
    pub(super) fn finish(self, g: &mut Graph) {
        let tensors = [
            (self.hidden, HIDDEN, NEXT_HIDDEN),
            (self.cell, CELL, NEXT_CELL),
        ];
        for (mut values, before, after) in tensors {
            if values.is_empty() {
                let nothing = g.constant(&[1], vec![0.0]);
                values.push(g.op("Mul", &[before, &nothing]));
            }
            let sum = g.sum(values);
            g.name(&sum, after);
        }
    }
}
