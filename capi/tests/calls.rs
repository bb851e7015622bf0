//! Every call of the interface as C makes it: right, wrong, from two threads, and without allocation.
#![allow(unsafe_code)]

use feedforward::guard::Status;
use feedforward::{Feedforward, Guard};
use physics::effects::{Sliding, Term};
use physics::robot::Robot;
use physics::torque_model::{TorqueModelRecord, WeightedTerm};
use residyn_c::*;
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::ffi::{CStr, CString};
use std::ptr::{null, null_mut};

thread_local! {
    static ALLOCATIONS: Cell<usize> = const { Cell::new(0) };
}

/// The system's allocator, counting the calls of each thread.
struct Counting;

// SAFETY: every call is handed on to `System` unchanged; the counter is a `Cell` without destructor in
// constant-initialised thread-local storage, so counting itself neither allocates nor unwinds.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.set(ALLOCATIONS.get() + 1);
        // SAFETY: the caller upholds the contract of `alloc`, which is that of `System`.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: `pointer` came from `alloc` above, thus from `System`, with the same layout.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

const N: usize = 6;

/// A UR5 with rotors and friction, as its model.json.
fn json() -> Vec<u8> {
    let robot = Robot::builtin("ur5").unwrap();
    let term = |term, value| WeightedTerm {
        term,
        value,
        std: 0.0,
    };
    let each = |j: usize| {
        vec![
            term(Term::Offset, 0.3),
            term(Term::RotorInertia, 0.1 * (j + 1) as f64),
            term(Term::Sliding(Sliding::Viscous), 2.0),
            term(Term::Sliding(Sliding::Coulomb), 5.0),
        ]
    };
    let own = robot.parameters();
    let record = TorqueModelRecord::new(&robot, own.clone(), own, (0..N).map(each).collect());
    let file = serde_json::json!({
        "schema": feedforward::model_file::SCHEMA, "physics": record, "preprocessing": {"fine_hz": 500.0}, "clock": [], "memory": [],
        "compensator": null,
    });
    file.to_string().into_bytes()
}

fn load() -> *mut Model {
    let text = json();
    let mut model = null_mut();
    // SAFETY: pointers to values that live during the call.
    let code = unsafe {
        residyn_load_memory_for(
            RESIDYN_ABI,
            text.as_ptr(),
            text.len(),
            null(),
            0,
            0.0,
            &mut model,
        )
    };
    assert_eq!(code, Code::ResidynOk, "{}", words());
    model
}

fn words() -> String {
    // SAFETY: a text of this thread.
    let text = unsafe { CStr::from_ptr(residyn_last_error()) };
    text.to_str().unwrap().to_owned()
}

#[track_caller]
fn refused(code: Code, expected: Code, fragment: &str) {
    assert_eq!(code, expected);
    assert!(words().contains(fragment), "{}", words());
}

/// Position, velocity and acceleration of sample `k`.
fn motion(k: usize) -> [[f64; N]; 3] {
    let at = |j: usize, d: usize| {
        let w = 1.0 + 0.2 * j as f64;
        let phase = w * k as f64 * 0.002 + d as f64 * std::f64::consts::FRAC_PI_2;
        0.4 * w.powi(d as i32) * phase.sin()
    };
    [0, 1, 2].map(|d| std::array::from_fn(|j| at(j, d)))
}

#[test]
fn torque_and_its_parts_are_those_of_rust() {
    let model = load();
    let mut own = Feedforward::from_bytes(&json(), None, None).unwrap();
    let [mut tau, mut expected, mut part] = [[0.0; N]; 3];
    let [mut m, mut own_m] = [[0.0; N * N]; 2];
    let mut status = 99;
    for k in 0..50 {
        let [q, qd, qdd] = motion(k);
        let [a, b, c] = [q.as_ptr(), qd.as_ptr(), qdd.as_ptr()];
        own.torque(&q, &qd, &qdd, &mut expected);
        // SAFETY: a handle in use here alone, arrays of this length.
        unsafe {
            let ok = |code: Code| assert_eq!(code, Code::ResidynOk, "{}", words());
            ok(residyn_torque(
                model,
                a,
                b,
                c,
                tau.as_mut_ptr(),
                N,
                &mut status,
            ));
            assert_eq!((tau, status), (expected, 0));
            ok(residyn_friction(model, part.as_mut_ptr(), N));
            for (j, friction) in part.iter().enumerate() {
                let coulomb = 5.0 * f64::from(i8::from(qd[j] > 0.0) - i8::from(qd[j] < 0.0));
                assert!((friction - 2.0 * qd[j] - coulomb).abs() < 1e-12);
            }
            let friction = part;
            ok(residyn_inverse_dynamics(
                model,
                a,
                b,
                c,
                part.as_mut_ptr(),
                N,
            ));
            for j in 0..N {
                assert!(
                    (tau[j] - part[j] - friction[j] - 0.3).abs() < 1e-9,
                    "the parts are the whole"
                );
            }
            let rigid = part;
            ok(residyn_forward_dynamics(
                model,
                a,
                b,
                rigid.as_ptr(),
                part.as_mut_ptr(),
                N,
            ));
            assert!(std::iter::zip(part, qdd).all(|(x, y)| (x - y).abs() < 1e-9));
            ok(residyn_compensator(model, part.as_mut_ptr(), N));
            assert_eq!(part, [0.0; N]);
            ok(residyn_range(model, part.as_mut_ptr(), N));
            assert_eq!(part, [f64::NEG_INFINITY; N]);
            ok(residyn_gravity(model, a, part.as_mut_ptr(), N));
            own.dynamics().gravity(&q, &mut expected);
            assert_eq!(part, expected);
            ok(residyn_mass_matrix(model, a, m.as_mut_ptr(), N));
            own.dynamics().mass_matrix(&q, &mut own_m);
            assert_eq!(m, own_m);
        }
    }
    // SAFETY: not used afterwards.
    assert_eq!(unsafe { residyn_free(model) }, Code::ResidynOk);
}

#[test]
fn what_a_handle_says_of_itself() {
    let model = load();
    let (mut n, mut name, mut period, mut compensated) = (0, null(), 0.0, 9);
    // SAFETY: a handle in use here alone, places for one value each.
    unsafe {
        assert_eq!(residyn_joints(model, &mut n), Code::ResidynOk);
        assert_eq!(residyn_period(model, &mut period), Code::ResidynOk);
        assert_eq!(
            residyn_is_compensated(model, &mut compensated),
            Code::ResidynOk
        );
        assert_eq!((n, period, compensated), (N, 0.002, 0));
        let expected = Robot::builtin("ur5").unwrap().joint_names();
        for (j, expected) in expected.iter().enumerate() {
            assert_eq!(residyn_joint_name(model, j, &mut name), Code::ResidynOk);
            assert_eq!(CStr::from_ptr(name).to_str().unwrap(), expected);
        }
        refused(
            residyn_joint_name(model, N, &mut name),
            Code::ResidynLength,
            "no such joint",
        );
        assert_eq!(
            CStr::from_ptr(residyn_version()).to_str().unwrap(),
            env!("CARGO_PKG_VERSION")
        );
        assert_eq!(residyn_abi(), RESIDYN_ABI);
        residyn_free(model);
    }
}

#[test]
fn what_cannot_be_loaded() {
    let text = json();
    let mut model = null_mut();
    let memory = |abi: u32, bytes: &[u8], period: f64, model: &mut *mut Model| {
        // SAFETY: pointers to values that live during the call.
        unsafe {
            residyn_load_memory_for(abi, bytes.as_ptr(), bytes.len(), null(), 0, period, model)
        }
    };
    refused(
        memory(RESIDYN_ABI + 1, &text, 0.0, &mut model),
        Code::ResidynVersion,
        "another libresidyn",
    );
    refused(
        memory(RESIDYN_ABI, &text[..text.len() / 2], 0.0, &mut model),
        Code::ResidynLoad,
        "model.json",
    );
    refused(
        memory(RESIDYN_ABI, b"{}", 0.0, &mut model),
        Code::ResidynLoad,
        "schema",
    );
    for period in [-1.0, f64::NAN, f64::INFINITY] {
        refused(
            memory(RESIDYN_ABI, &text, period, &mut model),
            Code::ResidynLoad,
            "period",
        );
    }
    let nowhere = CString::new("no/such/model").unwrap();
    // SAFETY: texts that live during the call, or null.
    unsafe {
        refused(
            residyn_load_for(RESIDYN_ABI, nowhere.as_ptr(), 0.0, &mut model),
            Code::ResidynLoad,
            "no/such/model",
        );
        refused(
            residyn_load_for(RESIDYN_ABI, null(), 0.0, &mut model),
            Code::ResidynPointer,
            "null",
        );
        let latin = c"\xff";
        refused(
            residyn_load_for(RESIDYN_ABI, latin.as_ptr(), 0.0, &mut model),
            Code::ResidynValue,
            "UTF-8",
        );
        refused(
            residyn_load_for(RESIDYN_ABI, nowhere.as_ptr(), 0.0, null_mut()),
            Code::ResidynPointer,
            "null",
        );
    }
    assert!(model.is_null());
}

#[test]
fn wrong_arrays_and_values_are_codes() {
    let model = load();
    let [q, qd, qdd] = motion(3);
    let [a, b, c] = [q.as_ptr(), qd.as_ptr(), qdd.as_ptr()];
    let mut tau = [7.0; N];
    let mut status = 0;
    // SAFETY: a handle in use here alone; arrays of this length where the call may come to use them.
    unsafe {
        let out = tau.as_mut_ptr();
        let torque = |q, out, n| residyn_torque(model, q, b, c, out, n, null_mut());
        refused(torque(null(), out, N), Code::ResidynPointer, "null");
        refused(torque(a, null_mut(), N), Code::ResidynPointer, "null");
        refused(
            torque(a.byte_add(1), out, N),
            Code::ResidynPointer,
            "aligned",
        );
        refused(torque(a, out, N - 1), Code::ResidynLength, "another number");
        refused(
            torque(out.add(1).cast_const(), out, N),
            Code::ResidynPointer,
            "overlaps",
        );
        refused(
            residyn_torque(null_mut(), a, b, c, out, N, &mut status),
            Code::ResidynPointer,
            "null",
        );
        let mut hole = qd;
        hole[2] = f64::NAN;
        refused(
            residyn_torque(model, a, hole.as_ptr(), c, out, N, &mut status),
            Code::ResidynNotFinite,
            "not finite",
        );
        refused(
            residyn_gravity(model, hole.as_ptr(), out, N),
            Code::ResidynNotFinite,
            "not finite",
        );
        let huge = [1e300; N];
        refused(
            residyn_torque(model, a, huge.as_ptr(), c, out, N, &mut status),
            Code::ResidynNotFinite,
            "model's torque",
        );
        assert_eq!(tau, [7.0; N], "what is refused leaves the torque as it was");
        refused(residyn_pause(model, -1.0), Code::ResidynValue, "pause");
        refused(
            residyn_set_times(model, f64::NAN, 0.1),
            Code::ResidynValue,
            "ramp",
        );
        let negative = [-1.0; N];
        refused(
            residyn_set_limits(model, negative.as_ptr(), null(), N),
            Code::ResidynValue,
            "torque",
        );
        refused(
            residyn_set_limits(model, null(), null(), 2),
            Code::ResidynLength,
            "limits",
        );
        // After all that it works.
        assert_eq!(
            residyn_torque(model, a, b, c, out, N, null_mut()),
            Code::ResidynOk
        );
        assert_eq!(residyn_free(null_mut()), Code::ResidynOk);
        residyn_free(model);
    }
}

#[test]
fn ticks_are_those_of_rust_and_nothing_in_the_loop_allocates() {
    let model = load();
    let mut own = Guard::new(Feedforward::from_bytes(&json(), None, None).unwrap());
    let [mut tau, mut expected] = [[0.0; N]; 2];
    let mut m = [0.0; N * N];
    let (mut status, mut pace) = (0, None);
    own.start();
    let mut allocations = 0;
    // SAFETY: a handle in use here alone, arrays of this length.
    unsafe {
        assert_eq!(residyn_start(model), Code::ResidynOk);
        for k in 0..400 {
            let [q, mut qd, qdd] = motion(k);
            if k % 50 == 49 {
                qd[0] = f64::NAN;
            }
            if k == 300 {
                own.stop();
                residyn_stop(model);
            }
            let time = k as f64 * 0.002 + if k > 200 { 0.004 } else { 0.0 };
            let flags = own.tick(time, &q, &qd, &qdd, &mut expected);
            let [a, b, c] = [q.as_ptr(), qd.as_ptr(), qdd.as_ptr()];
            let before = ALLOCATIONS.get();
            let out = tau.as_mut_ptr();
            let code = residyn_tick(model, time, a, b, c, out, N, &mut status);
            allocations += ALLOCATIONS.get() - before;
            assert_eq!(
                (code, status, tau),
                (Code::ResidynOk, flags.bits(), expected),
                "{k}"
            );
            let mut seen = Pace {
                ticks: 0,
                late: 0,
                missed: 0,
                mean: 0.0,
                longest: 0.0,
            };
            let before = ALLOCATIONS.get();
            for code in [
                residyn_torque(model, a, b, c, out, N, &mut status),
                residyn_inverse_dynamics(model, a, b, c, out, N),
                residyn_forward_dynamics(model, a, b, c, out, N),
                residyn_gravity(model, a, out, N),
                residyn_mass_matrix(model, a, m.as_mut_ptr(), N),
                residyn_friction(model, out, N),
                residyn_compensator(model, out, N),
                residyn_range(model, out, N),
                residyn_pace_of(model, &mut seen),
                residyn_pause(model, 0.0),
                residyn_reset(model, f64::NAN),
            ] {
                let hole = k % 50 == 49 && code == Code::ResidynNotFinite;
                assert!(code == Code::ResidynOk || hole, "{code:?}");
            }
            allocations += ALLOCATIONS.get() - before;
            // The other calls have moved the model's memory: both go on from none.
            own.model_mut().reset(None);
            pace = Some(seen);
        }
        residyn_free(model);
    }
    assert_eq!(allocations, 0, "a call of the loop allocates");
    let pace = pace.unwrap();
    assert_eq!(
        (pace.late, pace.missed),
        (own.pace().late, own.pace().missed)
    );
    assert_eq!(pace.late, 1);
    assert!(Status::STOPPED.bits() == RESIDYN_STOPPED && own.pace().ticks == pace.ticks);
}

/// A pointer that other threads may have.
#[derive(Clone, Copy)]
struct Shared(*mut Model);

// SAFETY: the test is about what happens then.
unsafe impl Send for Shared {}

#[test]
fn a_second_thread_is_refused_and_a_copy_is_its_own() {
    let model = Shared(load());
    let hammer = |shared: Shared| {
        let Shared(model) = shared;
        let [q, qd, qdd] = motion(1);
        let mut tau = [0.0; N];
        let (mut done, mut busy) = (0_u32, 0_u32);
        for _ in 0..20_000 {
            // SAFETY: a handle that lives until both threads are done.
            let code = unsafe {
                residyn_torque(
                    model,
                    q.as_ptr(),
                    qd.as_ptr(),
                    qdd.as_ptr(),
                    tau.as_mut_ptr(),
                    N,
                    null_mut(),
                )
            };
            match code {
                Code::ResidynOk => done += 1,
                Code::ResidynBusy => busy += 1,
                other => panic!("{other:?}: {}", words()),
            }
        }
        (done, busy)
    };
    let counts = std::thread::scope(|scope| {
        let threads = [
            scope.spawn(move || hammer(model)),
            scope.spawn(move || hammer(model)),
        ];
        threads.map(|t| t.join().unwrap())
    });
    assert!(counts.iter().all(|(done, busy)| done + busy == 20_000));
    assert!(counts.iter().any(|(done, _)| *done > 0));
    let mut copy = null_mut();
    // SAFETY: handles in use here alone.
    unsafe {
        assert_eq!(residyn_clone(model.0, &mut copy), Code::ResidynOk);
        assert_eq!(residyn_free(model.0), Code::ResidynOk);
    }
    assert_eq!(hammer(Shared(copy)), (20_000, 0));
    // SAFETY: not used afterwards.
    assert_eq!(unsafe { residyn_free(copy) }, Code::ResidynOk);
}
