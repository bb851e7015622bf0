//! The algorithms do not allocate once their workspace exists.

use nalgebra::Vector3;
use physics::dynamics::*;
use physics::robot::Robot;
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

thread_local! {
    static ALLOCATIONS: Cell<usize> = const { Cell::new(0) };
}

/// The system's allocator, counting the calls of each thread.
struct Counting;

// SAFETY: every call is handed on to `System` unchanged; the counter is a `Cell` without destructor in
// constant-initialised thread-local storage, so counting itself neither allocates nor unwinds.
#[allow(unsafe_code)]
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

#[test]
fn no_algorithm_allocates() {
    let robot = Robot::builtin("kr300").expect("built in");
    let mut workspace = Workspace::new(&robot);
    let (q, qd, qdd, armature) = ([0.3; 6], [-0.5; 6], [1.0; 6], [100.0; 6]);
    let (mut tau, mut acceleration) = ([0.0; 6], [0.0; 6]);
    let (mut mass, mut y, mut jacobian) = ([0.0; 36], [0.0; 360], [0.0; 36]);
    let before = ALLOCATIONS.get();
    inverse_dynamics(&robot, &mut workspace, &q, &qd, &qdd, &mut tau);
    regressor(&robot, &mut workspace, &q, &qd, &qdd, &mut y);
    mass_matrix(&robot, &mut workspace, &q, &mut mass);
    forward_dynamics(
        &robot,
        &mut workspace,
        &q,
        &qd,
        &tau,
        &armature,
        &mut acceleration,
    );
    point_jacobian(&robot, &mut workspace, &q, 5, &Vector3::x(), &mut jacobian);
    let placed = link_placements(&robot, &q).last().is_some();
    let energy = kinetic_energy(&robot, &q, &qd) + potential_energy(&robot, &q);
    assert_eq!(ALLOCATIONS.get(), before);
    assert!(placed && energy.is_finite());
    // The counter does count.
    drop(Workspace::new(&robot));
    assert!(ALLOCATIONS.get() > before);
}
