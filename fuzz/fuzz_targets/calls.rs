//! Any sequence of calls with any values on up to three handles: codes, never a panic; what residyn_tick gives is finite and
//! within the limits. Arrays are as long as the call says, so that AddressSanitizer sees a step beyond them.
//! Run with `RUSTC_BOOTSTRAP=1 cargo fuzz run calls`.
#![no_main]

mod robot;

use libfuzzer_sys::fuzz_target;
use residyn_c::*;
use robot::JOINTS;
use std::ptr::{null, null_mut};
use std::sync::OnceLock;

/// Bytes that choose calls and values; zeros after the end.
struct Choices<'a>(std::slice::Iter<'a, u8>);

impl Choices<'_> {
    fn byte(&mut self) -> u8 {
        self.0.next().copied().unwrap_or(0)
    }

    /// A small value, an absurd one, or any bits.
    fn value(&mut self) -> f64 {
        match self.byte() {
            250 => f64::NAN,
            251 => f64::INFINITY,
            252 => -1e300,
            253 => f64::MIN_POSITIVE,
            254 => 1e30,
            255 => f64::from_bits(u64::from_le_bytes([0; 8].map(|_: u8| self.byte()))),
            small => (f64::from(small) - 125.0) * 0.02,
        }
    }

    /// Usually one for each joint.
    fn count(&mut self) -> usize {
        match self.byte() {
            0 => 0,
            1 => JOINTS - 1,
            2 => JOINTS + 1,
            _ => JOINTS,
        }
    }

    fn values(&mut self, count: usize) -> Box<[f64]> {
        (0..count).map(|_| self.value()).collect()
    }
}

/// A pointer to values, sometimes null.
fn pointer(values: &[f64], choice: u8) -> *const f64 {
    if choice == 77 {
        null()
    } else {
        values.as_ptr()
    }
}

fn load() -> *mut Model {
    static FILES: OnceLock<[Vec<u8>; 2]> = OnceLock::new();
    let [json, network] = FILES.get_or_init(|| {
        let network = robot::network();
        [robot::model(Some(&network)), network]
    });
    let mut model = null_mut();
    // SAFETY: pointers to values that live during the call.
    let code = unsafe {
        residyn_load_memory_for(
            RESIDYN_ABI,
            json.as_ptr(),
            json.len(),
            network.as_ptr(),
            network.len(),
            0.002,
            &mut model,
        )
    };
    assert_eq!(code, Code::ResidynOk);
    model
}

/// One call on `model`, and its code.
///
/// # Safety
/// `model` is null or a handle.
unsafe fn call(model: *mut Model, limits: &mut Option<Box<[f64]>>, c: &mut Choices) -> Code {
    let kind = c.byte() % 18;
    let n = c.count();
    let [q, qd, qdd] = [0, 1, 2].map(|_| c.values(n));
    let mut out = vec![0.0; n].into_boxed_slice();
    let mut square = vec![0.0; n * n].into_boxed_slice();
    let (a, b, d) = (pointer(&q, c.byte()), qd.as_ptr(), qdd.as_ptr());
    let (tau, mut status) = (out.as_mut_ptr(), 0);
    // SAFETY: arrays have `n` values, and the matrix n·n.
    unsafe {
        match kind {
            0 => residyn_torque(model, a, b, d, tau, n, &mut status),
            1 => residyn_torque(model, a, b, d, a.cast_mut(), n, null_mut()),
            2 => residyn_inverse_dynamics(model, a, b, d, tau, n),
            3 => residyn_gravity(model, a, tau, n),
            4 => residyn_mass_matrix(model, a, square.as_mut_ptr(), n),
            5 => residyn_forward_dynamics(model, a, b, d, tau, n),
            6 => residyn_friction(model, tau, n),
            7 => residyn_compensator(model, tau, n),
            8 => residyn_range(model, tau, n),
            9 => residyn_reset(model, c.value()),
            10 => residyn_pause(model, c.value()),
            11 => residyn_start(model),
            12 => residyn_stop(model),
            13 => {
                let code = residyn_set_limits(model, a, b, n);
                if code == Code::ResidynOk && !a.is_null() {
                    *limits = Some(q);
                }
                code
            }
            14 => residyn_set_times(model, c.value(), c.value()),
            15 => residyn_set_drive(model, c.value(), i32::from(c.byte() % 2)),
            16 => {
                let mut pace = Pace {
                    ticks: 0,
                    late: 0,
                    missed: 0,
                    mean: 0.0,
                    longest: 0.0,
                };
                residyn_pace_of(model, &mut pace)
            }
            _ => {
                let code = residyn_tick(model, c.value(), a, b, d, tau, n, &mut status);
                if code == Code::ResidynOk {
                    assert!(out.iter().all(|t| t.is_finite()), "{out:?}");
                    if let Some(limits) = limits {
                        let within = out.iter().zip(&limits[..]).all(|(t, l)| t.abs() <= *l);
                        assert!(within, "{out:?} of {limits:?}");
                    }
                }
                code
            }
        }
    }
}

fuzz_target!(|bytes: &[u8]| {
    let mut choices = Choices(bytes.iter());
    let mut handles = vec![(load(), None)];
    while choices.0.len() > 0 {
        let which = choices.byte();
        let count = handles.len();
        let (place, what) = (usize::from(which) % count, which / 64);
        let (model, limits) = &mut handles[place];
        // SAFETY: handles that were made here and not freed.
        unsafe {
            match what {
                0 if which % 8 == 0 && count < 3 => {
                    let (limits, mut twin) = (limits.clone(), null_mut());
                    assert_eq!(residyn_clone(*model, &mut twin), Code::ResidynOk);
                    handles.push((twin, limits));
                }
                1 if which % 8 == 0 && count > 1 => {
                    let (model, _) = handles.swap_remove(place);
                    assert_eq!(residyn_free(model), Code::ResidynOk);
                }
                _ => assert_ne!(call(*model, limits, &mut choices), Code::ResidynPanic),
            }
        }
    }
    for (model, _) in handles {
        // SAFETY: made here, freed once.
        assert_eq!(unsafe { residyn_free(model) }, Code::ResidynOk);
    }
});
