//! LSTM layer over a sequence: forward step, backward step, weight gradient (equations 14–18).
//!
//! One weight matrix W of shape (input + hidden) × 4·hidden acts on z_t = [x_t; h_{t−1}]; its columns are
//! the gates in the order input i, forget f, cell g, output o.

use pulp::{Arch, Simd, WithSimd};

use super::matmul::{View, ViewMut, multiply, multiply_add};
use super::real::{Real, add_rows};

/// Widths of an LSTM layer: inputs and hidden units.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Widths {
    /// Number of inputs of the layer.
    pub(crate) input: usize,
    /// Number of hidden units.
    pub(crate) hidden: usize,
}

/// Intermediate results of an LSTM layer's forward pass, kept for the backward pass.
#[derive(Debug)]
pub(crate) struct Lstm<T> {
    /// Numbers of inputs and hidden units.
    pub(crate) widths: Widths,
    /// Number of rows of the batch.
    batch: usize,
    /// Inputs z_t = [x_t; h_{t−1}] of each step, (steps + 1) blocks of batch × (input + hidden). The last block holds
    /// the final h.
    joined: Vec<T>,
    /// Activated gates, steps blocks of batch × 4·hidden. After a backward step, that step's gradients before
    /// activation.
    gates: Vec<T>,
    /// Cell state c_{t−1} before each step, (steps + 1) blocks of batch × hidden.
    cell: Vec<T>,
    /// Values tanh c_t after each step, steps blocks of batch × hidden.
    bent: Vec<T>,
}

impl<T: Real> Lstm<T> {
    /// Layer of these widths without values.
    pub(crate) fn new(widths: Widths) -> Self {
        Self {
            widths,
            batch: 0,
            joined: Vec::new(),
            gates: Vec::new(),
            cell: Vec::new(),
            bent: Vec::new(),
        }
    }

    /// Starts a forward pass: sets the sizes, and the state before the first step to zero.
    pub(crate) fn begin(&mut self, batch: usize, steps: usize) {
        let Widths { input, hidden } = self.widths;
        self.batch = batch;
        self.joined
            .resize((steps + 1) * batch * (input + hidden), T::ZERO);
        self.gates.resize(steps * batch * 4 * hidden, T::ZERO);
        self.cell.resize((steps + 1) * batch * hidden, T::ZERO);
        self.bent.resize(steps * batch * hidden, T::ZERO);
        for row in self.joined[..batch * (input + hidden)].chunks_exact_mut(input + hidden) {
            row[input..].fill(T::ZERO);
        }
        self.cell[..batch * hidden].fill(T::ZERO);
    }

    /// Number of columns of z_t: inputs and hidden units.
    fn width(&self) -> usize {
        self.widths.input + self.widths.hidden
    }

    /// Input x_t of one row, to be written before [`Self::step`].
    pub(crate) fn input_mut(&mut self, t: usize, row: usize) -> &mut [T] {
        let (width, input) = (self.width(), self.widths.input);
        &mut self.joined[(t * self.batch + row) * width..][..input]
    }

    /// Inputs x_t of all rows from column `from` on, with the number of elements from row to row.
    pub(crate) fn inputs_mut(&mut self, t: usize, from: usize) -> (&mut [T], usize) {
        let width = self.width();
        (&mut self.joined[t * self.batch * width + from..], width)
    }

    /// Hidden state h_{t−1} of every row as a matrix; that after the last step is `previous(steps)`.
    pub(crate) fn previous(&self, t: usize) -> View<'_, T> {
        let width = self.width();
        View::new(
            &self.joined[t * self.batch * width + self.widths.input..],
            self.batch,
            self.widths.hidden,
            width,
        )
    }

    /// Hidden state h_{t−1} before step t, of one row of the batch.
    pub(crate) fn previous_row(&self, t: usize, row: usize) -> &[T] {
        let width = self.width();
        &self.joined[(t * self.batch + row) * width..][self.widths.input..width]
    }

    /// Forward pass of step t for the whole batch.
    pub(crate) fn step(&mut self, arch: Arch, t: usize, weight: &[T], bias: &[T]) {
        let (width, Widths { input, hidden }, batch) = (self.width(), self.widths, self.batch);
        let gates = &mut self.gates[t * batch * 4 * hidden..][..batch * 4 * hidden];
        for row in gates.chunks_exact_mut(4 * hidden) {
            row.copy_from_slice(bias);
        }
        // The state before the first step is zero: its products are left away.
        let used = if t == 0 { input } else { width };
        let (now, next) = self.joined.split_at_mut((t + 1) * batch * width);
        multiply_add(
            ViewMut::new(gates, batch, 4 * hidden, 4 * hidden),
            View::new(&now[t * batch * width..], batch, used, width),
            View::new(weight, used, 4 * hidden, 4 * hidden),
        );
        let (before, after) = self.cell.split_at_mut((t + 1) * batch * hidden);
        arch.dispatch(Activate {
            widths: self.widths,
            gates,
            before: &before[t * batch * hidden..],
            after,
            bent: &mut self.bent[t * batch * hidden..],
            next,
        });
    }

    /// Backward step t: takes ∂L/∂h_t and ∂L/∂c_t, leaves the gates' gradients in place and ∂L/∂c_{t−1} in
    /// `cell`.
    pub(crate) fn step_back(
        &mut self,
        arch: Arch,
        t: usize,
        hidden_gradient: &[T],
        cell_gradient: &mut [T],
    ) {
        let (hidden, batch) = (self.widths.hidden, self.batch);
        let gates = &mut self.gates[t * batch * 4 * hidden..][..batch * 4 * hidden];
        arch.dispatch(Deactivate {
            hidden,
            gates,
            before: &self.cell[t * batch * hidden..],
            bent: &self.bent[t * batch * hidden..],
            hidden_gradient,
            cell_gradient,
        });
    }

    /// ∂L/∂z_t restricted to the columns `from..to` of z, after [`Self::step_back`]: dG_t · W[from..to]ᵀ,
    /// written to `out` (batch × (to − from)).
    pub(crate) fn joined_gradient(
        &self,
        t: usize,
        weight: &[T],
        columns: std::ops::Range<usize>,
        out: &mut [T],
    ) {
        let (gates, batch) = (4 * self.widths.hidden, self.batch);
        let count = columns.len();
        multiply(
            ViewMut::new(out, batch, count, count),
            View::new(&self.gates[t * batch * gates..], batch, gates, gates),
            View::new(&weight[columns.start * gates..], count, gates, gates).t(),
        );
    }

    /// Adds Σ_t z_tᵀ·dG_t to `weight` and Σ_t dG_t to `bias`, once every step went back.
    pub(crate) fn weight_gradient(&self, steps: usize, weight: &mut [T], bias: &mut [T]) {
        let (width, Widths { input, hidden }, batch) = (self.width(), self.widths, self.batch);
        let gates = 4 * hidden;
        let (on_input, on_state) = weight.split_at_mut(input * gates);
        multiply_add(
            ViewMut::new(on_input, input, gates, gates),
            View::new(&self.joined, steps * batch, input, width).t(),
            View::new(&self.gates, steps * batch, gates, gates),
        );
        if steps > 1 {
            multiply_add(
                ViewMut::new(on_state, hidden, gates, gates),
                View::new(
                    &self.joined[batch * width + input..],
                    (steps - 1) * batch,
                    hidden,
                    width,
                )
                .t(),
                View::new(
                    &self.gates[batch * gates..],
                    (steps - 1) * batch,
                    gates,
                    gates,
                ),
            );
        }
        add_rows(bias, &self.gates[..steps * batch * gates]);
    }
}

/// [`activate`] on every row of a batch.
struct Activate<'a, T> {
    widths: Widths,
    gates: &'a mut [T],
    before: &'a [T],
    after: &'a mut [T],
    bent: &'a mut [T],
    next: &'a mut [T],
}

impl<T: Real> WithSimd for Activate<'_, T> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Widths { input, hidden: n } = self.widths;
        for (row, gates) in self.gates.chunks_exact_mut(4 * n).enumerate() {
            let (i, rest) = gates.split_at_mut(n);
            let (f, rest) = rest.split_at_mut(n);
            let (g, o) = rest.split_at_mut(n);
            let cells = row * n..(row + 1) * n;
            activate(
                (i, f, g, o),
                &self.before[cells.clone()],
                &mut self.after[cells.clone()],
                &mut self.bent[cells],
                &mut self.next[row * (input + n) + input..][..n],
            );
        }
    }
}

/// Gates i, f, g and o of one row.
type Gates<'a, T> = (&'a mut [T], &'a mut [T], &'a mut [T], &'a mut [T]);

/// c = f∘c₋ + i∘g, h = o∘tanh c; the gates are activated in place.
#[inline(always)]
fn activate<T: Real>(
    gates: Gates<T>,
    before: &[T],
    after: &mut [T],
    bent: &mut [T],
    hidden: &mut [T],
) {
    let n = hidden.len();
    let (i, f, g, o) = (
        &mut gates.0[..n],
        &mut gates.1[..n],
        &mut gates.2[..n],
        &mut gates.3[..n],
    );
    let (before, after, bent) = (&before[..n], &mut after[..n], &mut bent[..n]);
    for k in 0..n {
        i[k] = i[k].sigmoid();
        f[k] = f[k].sigmoid();
        g[k] = g[k].tanh();
        o[k] = o[k].sigmoid();
        after[k] = f[k] * before[k] + i[k] * g[k];
        bent[k] = after[k].tanh();
        hidden[k] = o[k] * bent[k];
    }
}

/// [`deactivate`] on every row of a batch.
struct Deactivate<'a, T> {
    hidden: usize,
    gates: &'a mut [T],
    before: &'a [T],
    bent: &'a [T],
    hidden_gradient: &'a [T],
    cell_gradient: &'a mut [T],
}

impl<T: Real> WithSimd for Deactivate<'_, T> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let n = self.hidden;
        for (row, gates) in self.gates.chunks_exact_mut(4 * n).enumerate() {
            let (i, rest) = gates.split_at_mut(n);
            let (f, rest) = rest.split_at_mut(n);
            let (g, o) = rest.split_at_mut(n);
            let cells = row * n..(row + 1) * n;
            deactivate(
                (i, f, g, o),
                &self.before[cells.clone()],
                &self.bent[cells.clone()],
                &self.hidden_gradient[cells.clone()],
                &mut self.cell_gradient[cells],
            );
        }
    }
}

/// Chain rule through [`activate`]: activated gates become gradients before activation.
#[inline(always)]
fn deactivate<T: Real>(gates: Gates<T>, before: &[T], bent: &[T], dh: &[T], dc: &mut [T]) {
    let n = dc.len();
    let (i, f, g, o) = (
        &mut gates.0[..n],
        &mut gates.1[..n],
        &mut gates.2[..n],
        &mut gates.3[..n],
    );
    let (before, bent, dh) = (&before[..n], &bent[..n], &dh[..n]);
    for k in 0..n {
        let d = dc[k] + dh[k] * o[k] * (T::ONE - bent[k] * bent[k]);
        o[k] = dh[k] * bent[k] * o[k] * (T::ONE - o[k]);
        dc[k] = d * f[k];
        f[k] = d * before[k] * f[k] * (T::ONE - f[k]);
        let input = i[k];
        i[k] = d * g[k] * input * (T::ONE - input);
        g[k] = d * input * (T::ONE - g[k] * g[k]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One step by hand: x = 1, h₀ = 0, one hidden unit, gate sums i = 0.5, f = 0, g = 1, o = −0.5.
    /// i = σ(0.5) = 0.622459, g = tanh 1 = 0.761594, c = i·g = 0.474061, tanh c = 0.441475,
    /// o = σ(−0.5) = 0.377541, h = o·tanh c = 0.166675.
    #[test]
    fn one_step_matches_the_hand_calculation() {
        let mut lstm = Lstm::<f64>::new(Widths {
            input: 1,
            hidden: 1,
        });
        lstm.begin(1, 1);
        lstm.input_mut(0, 0)[0] = 1.0;
        let weight = [0.4, 0.0, 0.7, -0.6, 9.0, 9.0, 9.0, 9.0];
        lstm.step(Arch::new(), 0, &weight, &[0.1, 0.0, 0.3, 0.1]);
        assert!((lstm.cell[1] - 0.474061).abs() < 1e-6, "{}", lstm.cell[1]);
        assert!((lstm.previous_row(1, 0)[0] - 0.166675).abs() < 1e-6);
    }
}
