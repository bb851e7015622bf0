//! Shape of a unit and the layout of its parameters in one flat vector.

use std::ops::Range;

use serde::{Deserialize, Serialize};

/// Most samples or states that an output looks back on: a file that asks for more would take the memory of the loop's machine.
const LONGEST: usize = 4096;

/// Memory of a recurrent unit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", tag = "kind", deny_unknown_fields)]
pub enum Memory {
    /// Every output is computed from the last `timestep` samples alone, from zero states. A window that
    /// would reach before the start of the trajectory repeats its first sample.
    Window {
        /// Number of samples per window, T in Wang et al. (2, 3, 5 or 10 there).
        timestep: usize,
    },
    /// States run on from sample to sample until they are reset; attention sees the last `attended`
    /// encoder states.
    Carried {
        /// Encoder states that attention chooses from.
        attended: usize,
    },
}

/// LSTM encoder → additive attention → LSTM re-encoder → dense 1.
///
/// With encoder states h₁ … h_T (equations 14–18, cell input through tanh instead of the σ printed in
/// equation 17) and re-encoder state s, step t of the re-encoder is
///
/// ```text
/// e_u = w_aᵀ tanh(W_s s_{t−1} + W_h h_u + b_a)      (24)
/// α   = softmax(e)                                  (23)
/// V_t = Σ_u α_u h_u                                 (22)
/// s_t = LSTM([h_t; V_t], s_{t−1})                   (21)
/// ```
///
/// and the output is wᵀ s_T + b. The merge "with the input from the encoder layer" is the concatenation
/// [h_t; V_t], so w_t of equation 21 is h_t. Without attention the re-encoder sees h_t alone.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Recurrent {
    /// Hidden width of the encoder, H₁.
    pub encoder: usize,
    /// Width A of the attention layer; none without attention.
    pub attention: Option<usize>,
    /// Hidden width of the re-encoder, H₂.
    pub reencoder: usize,
    /// Memory of the unit: a window, or carried state.
    pub memory: Memory,
}

/// Architecture of a unit's network.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Architecture {
    /// Recurrent unit of Wang et al. (error-learning unit), or its variant with carried state.
    Recurrent(Recurrent),
    /// Fully connected with tanh hidden layers over a flattened window, oldest sample first. No hidden
    /// layer: a linear model.
    Perceptron {
        /// Nodes of each hidden layer.
        hidden: Vec<usize>,
        /// Number of samples per window.
        timestep: usize,
    },
}

/// One parameter tensor: y = x·W + b with W of shape (inputs, outputs), row-major.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Tensor {
    /// Name inside the unit, e.g. `encoder.weight`.
    pub name: String,
    /// Rows and columns; a vector has one row.
    pub shape: [usize; 2],
    /// Place in the flat parameter vector.
    pub range: Range<usize>,
}

impl Architecture {
    /// Samples that one output looks back on, itself included (1 where state is carried).
    pub fn timestep(&self) -> usize {
        match self {
            Self::Recurrent(Recurrent {
                memory: Memory::Window { timestep },
                ..
            })
            | Self::Perceptron { timestep, .. } => *timestep,
            Self::Recurrent(_) => 1,
        }
    }

    /// Encoder states that attention chooses from.
    pub(super) fn attended(&self) -> usize {
        match self {
            Self::Recurrent(Recurrent {
                memory: Memory::Carried { attended },
                ..
            }) => *attended,
            _ => self.timestep(),
        }
    }

    /// Parameter tensors in their order in the flat vector, for `inputs` input columns.
    ///
    /// LSTM weights act on [x; h] and give the gates in the order input, forget, cell, output. Returns
    /// `None` where a width is zero, the sizes overflow, or an output looks back on more than 4096 samples.
    pub fn tensors(&self, inputs: usize) -> Option<Vec<Tensor>> {
        let looked_at = [self.timestep(), self.attended()];
        if inputs == 0 || looked_at.iter().any(|n| !(1..=LONGEST).contains(n)) {
            return None;
        }
        let mut shapes: Vec<(String, [usize; 2])> = Vec::new();
        match self {
            Self::Recurrent(Recurrent {
                encoder,
                attention,
                reencoder,
                ..
            }) => {
                let (h, s) = (*encoder, *reencoder);
                let merged = if attention.is_some() {
                    h.checked_mul(2)?
                } else {
                    h
                };
                shapes.push((
                    "encoder.weight".into(),
                    [inputs.checked_add(h)?, h.checked_mul(4)?],
                ));
                shapes.push(("encoder.bias".into(), [1, h.checked_mul(4)?]));
                if let Some(a) = *attention {
                    shapes.push(("attention.query".into(), [s, a]));
                    shapes.push(("attention.key".into(), [h, a]));
                    shapes.push(("attention.bias".into(), [1, a]));
                    shapes.push(("attention.score".into(), [1, a]));
                }
                shapes.push((
                    "reencoder.weight".into(),
                    [merged.checked_add(s)?, s.checked_mul(4)?],
                ));
                shapes.push(("reencoder.bias".into(), [1, s.checked_mul(4)?]));
                shapes.push(("output.weight".into(), [s, 1]));
                shapes.push(("output.bias".into(), [1, 1]));
            }
            Self::Perceptron { hidden, timestep } => {
                let mut width = inputs.checked_mul(*timestep)?;
                for (i, &next) in hidden.iter().chain(std::iter::once(&1)).enumerate() {
                    shapes.push((format!("layer{i}.weight"), [width, next]));
                    shapes.push((format!("layer{i}.bias"), [1, next]));
                    width = next;
                }
            }
        }
        let mut start = 0_usize;
        shapes
            .into_iter()
            .map(|(name, shape)| {
                let size = shape[0].checked_mul(shape[1]).filter(|&n| n > 0)?;
                let range = start..start.checked_add(size)?;
                start = range.end;
                Some(Tensor { name, shape, range })
            })
            .collect()
    }

    /// Length of the flat parameter vector, or `None` as for [`Self::tensors`].
    pub fn parameter_count(&self, inputs: usize) -> Option<usize> {
        Some(self.tensors(inputs)?.last()?.range.end)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paper_unit_has_the_expected_number_of_parameters() {
        let unit = |attention| {
            Architecture::Recurrent(Recurrent {
                encoder: 128,
                attention,
                reencoder: 128,
                memory: Memory::Window { timestep: 3 },
            })
        };
        // LSTM(18→128) + LSTM(128→128) + dense, one bias per gate.
        let plain = (18 + 128) * 512 + 512 + (128 + 128) * 512 + 512 + 129;
        assert_eq!(unit(None).parameter_count(18), Some(plain));
        let attention = 2 * 128 * 128 + 2 * 128 + 128 * 512;
        assert_eq!(unit(Some(128)).parameter_count(18), Some(plain + attention));
    }

    #[test]
    fn sizes_that_overflow_or_vanish_are_refused() {
        let huge = Architecture::Perceptron {
            hidden: vec![usize::MAX],
            timestep: 1,
        };
        assert_eq!(huge.parameter_count(3), None);
        let empty = Architecture::Perceptron {
            hidden: vec![0],
            timestep: 1,
        };
        assert_eq!(empty.parameter_count(3), None);
        let linear = |timestep| {
            let hidden = vec![];
            Architecture::Perceptron { hidden, timestep }.parameter_count(3)
        };
        assert_eq!(linear(0), None);
        assert_eq!(linear(4097), None);
        assert_eq!(linear(4096), Some(3 * 4096 + 1));
    }
}
