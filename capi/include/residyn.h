/* C interface of residyn: torque feedforward of a robot arm in a control loop. See docs/embedding.md. */
/* Written from capi/src; changes belong there. */

#ifndef RESIDYN_H
#define RESIDYN_H

#include <stddef.h>
#include <stdint.h>

/* One thread at a time may use a handle; its calls return RESIDYN_BUSY to a second one. Calls that take a motion do not allocate,
   take no lock and wait for nothing. Arrays have one value per joint, base first, in SI units. */

/* Loading, with the version of this header. */
#define residyn_load(directory, period, model) residyn_load_for(RESIDYN_ABI, directory, period, model)
#define residyn_load_memory(json, json_length, network, network_length, period, model) \
    residyn_load_memory_for(RESIDYN_ABI, json, json_length, network, network_length, period, model)


/*
 Version of this interface: the header and the library that runs must have the same.
 */
#define RESIDYN_ABI 1

/*
 A value of the motion or the time is not finite; the last torque is held.
 */
#define RESIDYN_BAD_INPUT 1

/*
 The model's torque is not finite; the last torque is held.
 */
#define RESIDYN_BAD_TORQUE 2

/*
 The time lies before that of the last tick; the last torque is held and time starts anew.
 */
#define RESIDYN_BACKWARD 4

/*
 Less than half a period after the last sample; the last torque is held.
 */
#define RESIDYN_STALE 8

/*
 A period or more passed without a tick.
 */
#define RESIDYN_LATE 16

/*
 An old torque stood for longer than it may: the torque goes to zero, until the next start.
 */
#define RESIDYN_OVERRUN 32

/*
 A torque was cut at its limit.
 */
#define RESIDYN_TORQUE_LIMITED 64

/*
 A torque was not let change so fast.
 */
#define RESIDYN_RATE_LIMITED 128

/*
 A position lies outside the robot's limits.
 */
#define RESIDYN_POSITION_OUTSIDE 256

/*
 A compensator is faded, for the motion lies outside its training.
 */
#define RESIDYN_FADED 512

/*
 A compensator is off, for the motion lies far outside its training.
 */
#define RESIDYN_UNCOMPENSATED 1024

/*
 The torque grows to the model's after a start.
 */
#define RESIDYN_STARTING 2048

/*
 The torque goes to zero after a stop.
 */
#define RESIDYN_STOPPING 4096

/*
 The torque is zero: before the first start, or after a stop.
 */
#define RESIDYN_STOPPED 8192

/*
 What became of a call.
 */
typedef enum residyn_code {
    /*
     Done.
     */
    RESIDYN_OK = 0,
    /*
     A pointer is null, not aligned, or two that must not overlap do.
     */
    RESIDYN_POINTER = 1,
    /*
     Another number of values than the model has joints, or no such joint.
     */
    RESIDYN_LENGTH = 2,
    /*
     A value is not finite.
     */
    RESIDYN_NOT_FINITE = 3,
    /*
     A value that is no setting: a negative limit, a text that is not UTF-8.
     */
    RESIDYN_VALUE = 4,
    /*
     The model cannot be read: missing, damaged, of another version, not for this period, or with another network than
     model.json has the checksum of. model.json itself has none: an altered value there is not noticed.
     */
    RESIDYN_LOAD = 5,
    /*
     The header belongs to another library than the one that runs.
     */
    RESIDYN_VERSION = 6,
    /*
     Another thread is in a call on the same handle.
     */
    RESIDYN_BUSY = 7,
    /*
     A bug of the library. Its handle can only be freed.
     */
    RESIDYN_PANIC = 8,
} residyn_code;

/*
 A loaded model with its memory. One thread at a time may use it; residyn_clone makes one for another thread.
 */
typedef struct residyn_model residyn_model;

/*
 How the caller has kept its period since the last start.
 */
typedef struct residyn_pace {
    /*
     Ticks whose time could be used.
     */
    uint64_t ticks;
    /*
     Ticks that came a period late or more.
     */
    uint64_t late;
    /*
     Periods that passed without a tick.
     */
    uint64_t missed;
    /*
     Mean time from tick to tick, s.
     */
    double mean;
    /*
     Longest time from tick to tick, s.
     */
    double longest;
} residyn_pace;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

/*
 Words for the last call of this thread that returned another code than RESIDYN_OK; empty before the first. The text stays until
 the next such call of the thread.
 */
const char *residyn_last_error(void);

/*
 Version of the interface of the library that runs.
 */
uint32_t residyn_abi(void);

/*
 Version of the library that runs, such as "0.1.0".
 */
const char *residyn_version(void);

/*
 Loads a model directory for a loop of `period` seconds (0: the period of training) into `model`. Call it as residyn_load, which
 hands the header's RESIDYN_ABI on.
 */
enum residyn_code residyn_load_for(uint32_t abi, const char *directory, double period, struct residyn_model **model);

/*
 Loads a model from the contents of its model.json and of its compensator.safetensors (null and 0: the physics alone), as
 residyn_load does. Call it as residyn_load_memory.
 */
enum residyn_code residyn_load_memory_for(uint32_t abi,
                                          const uint8_t *json,
                                          size_t json_length,
                                          const uint8_t *network,
                                          size_t network_length,
                                          double period,
                                          struct residyn_model **model);

/*
 Another handle with the same model in the same state, for another thread.
 */
enum residyn_code residyn_clone(const struct residyn_model *model, struct residyn_model **copy);

/*
 Frees a handle; null is allowed. A handle in use by another thread is not freed.
 */
enum residyn_code residyn_free(struct residyn_model *model);

/*
 Number of joints.
 */
enum residyn_code residyn_joints(const struct residyn_model *model, size_t *joints);

/*
 Name of a joint (0: at the base), as the robot's description has it. The text lives as long as the handle.
 */
enum residyn_code residyn_joint_name(const struct residyn_model *model, size_t joint, const char **name);

/*
 Control period, s.
 */
enum residyn_code residyn_period(const struct residyn_model *model, double *period);

/*
 Whether the model has a compensator: 1, or 0 where it is physics alone.
 */
enum residyn_code residyn_is_compensated(const struct residyn_model *model, int *answer);

/*
 Forgets friction memory and windows. `clock` is the time of the next sample on the clock of the training recordings, s, where this
 loop continues it; NaN where it is not known.
 */
enum residyn_code residyn_reset(struct residyn_model *model,
                                double clock);

/*
 Starts a new trajectory `seconds` after the last sample: friction memory and clock run on, windows start anew.
 */
enum residyn_code residyn_pause(struct residyn_model *model, double seconds);

/*
 Torque `tau` of all `n` joints (N·m or N) for the motion of this control period, base first: rad or m, per s, per s². `status` gets
 RESIDYN_FADED, RESIDYN_UNCOMPENSATED and RESIDYN_POSITION_OUTSIDE, or is null. No limits: residyn_tick has them.

 The torque is that of residyn_inverse_dynamics, residyn_friction and residyn_compensator, and a rest that no call gives: each joint's
 constant offset and, where the model has them, ripple, springs, counterbalance and coupling.

 Where a value is not finite, `tau` stays as it was, and the period has passed without a sample.
 */
enum residyn_code residyn_torque(struct residyn_model *model,
                                 const double *q,
                                 const double *qd,
                                 const double *qdd,
                                 double *tau,
                                 size_t n,
                                 uint32_t *status);

/*
 What of the last torque was friction, N·m or N, by joint, without the joint's constant offset.
 */
enum residyn_code residyn_friction(struct residyn_model *model, double *tau, size_t n);

/*
 What of the last torque was the compensator's, N·m or N, by joint; zero without one.
 */
enum residyn_code residyn_compensator(struct residyn_model *model, double *tau, size_t n);

/*
 How far the last sample lay outside the compensator's training, by joint: the largest part of an input's span, or of the largest
 distance of training, that it lies beyond. Zero or less inside: an input that sits at the edge of its training, such as a friction
 state at its limit, makes it zero, and most samples have one. The compensator fades from 0.1 to 0.6. A sample is one of
 residyn_torque or residyn_tick, before the start and after a stop as well; residyn_reset leaves the value. Minus infinity before
 the first sample, and where nothing was learned.
 */
enum residyn_code residyn_range(struct residyn_model *model,
                                double *excess,
                                size_t n);

/*
 Torque `tau` of the rigid body with its rotors (N·m or N) for a motion: no friction, springs or compensator. No memory: it may be
 called at any time, for any motion.
 */
enum residyn_code residyn_inverse_dynamics(struct residyn_model *model,
                                           const double *q,
                                           const double *qd,
                                           const double *qdd,
                                           double *tau,
                                           size_t n);

/*
 Torque `tau` that holds the rigid body at `q` against gravity, N·m or N.
 */
enum residyn_code residyn_gravity(struct residyn_model *model, const double *q, double *tau, size_t n);

/*
 Mass matrix of the rigid body with its rotors at `q`: n × n values, symmetric, row by row. Of parameters as identified: positive
 definite for certain only where they were held to possible bodies (train --lmi last).
 */
enum residyn_code residyn_mass_matrix(struct residyn_model *model, const double *q, double *matrix, size_t n);

/*
 Acceleration `qdd` of the rigid body with its rotors under `tau`, from which friction and the rest were taken off. By the matrix of
 residyn_mass_matrix: a negative inertia turns the acceleration round.
 */
enum residyn_code residyn_forward_dynamics(struct residyn_model *model,
                                           const double *q,
                                           const double *qd,
                                           const double *tau,
                                           double *qdd,
                                           size_t n);

/*
 Sets the largest torque (N·m or N) and its fastest change (N·m/s or N/s) by joint; null leaves one as it is, infinity is none.
 Before, the torque is limited as the robot's description says, and its change is not: a reference that jumps makes the torque jump.
 Not for the loop: it allocates.
 */
enum residyn_code residyn_set_limits(struct residyn_model *model,
                                     const double *torque,
                                     const double *rate,
                                     size_t n);

/*
 Sets the time of the ramps after start and stop (0.5 s before), and the longest time that an old torque may stand while the input
 is bad or no tick comes (0.02 s before). Not for the loop: it allocates.
 */
enum residyn_code residyn_set_times(struct residyn_model *model, double ramp, double hold);

/*
 Sets what the drive does by itself: by how much it is late (s, 0 before), for which the model is asked for the motion so much later;
 and whether it adds gravity's torque (0, as before, or 1), which is then left out. Not for the loop: it allocates.
 */
enum residyn_code residyn_set_drive(struct residyn_model *model,
                                    double delay,
                                    int32_t adds_gravity);

/*
 Lets the torque of residyn_tick grow from what was sent last (0 at first) to the model's.
 */
enum residyn_code residyn_start(struct residyn_model *model);

/*
 Lets the torque of residyn_tick go from what was sent last to zero.
 */
enum residyn_code residyn_stop(struct residyn_model *model);

/*
 Torque `tau` to send at `time` (s, of a clock that does not jump) for the motion of this tick, within limits, whatever comes in:
 `status` says by flags what happened. A value that is not finite is a flag here, not a code. Zero before residyn_start.
 */
enum residyn_code residyn_tick(struct residyn_model *model,
                               double time,
                               const double *q,
                               const double *qd,
                               const double *qdd,
                               double *tau,
                               size_t n,
                               uint32_t *status);

/*
 How the caller of residyn_tick has kept its period since the last start.
 */
enum residyn_code residyn_pace_of(struct residyn_model *model, struct residyn_pace *pace);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* RESIDYN_H */
