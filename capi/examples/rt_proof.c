/* Whether a tick is fit for real time: rt_proof MODEL [PERIOD [TICKS]]
   Calls residyn_tick TICKS times (a million unless given) on a motion of sines, unpaced, with all memory locked, and counts what a loop
   must not do: allocations (this program stands in for malloc and its kin), page faults, waits. A child does the same behind a filter
   of the kernel that ends it at its first system call. Then, in a loop of its own, the thread CPU time of each tick is taken: median,
   99.9 %, 99.999 %, largest; and the time by the clock as a histogram, which other programs and the scheduler widen. The same is timed
   with motion that has faded to denormal numbers. Exit status 1 where a loop did what it must not. Linux. */
#define _GNU_SOURCE
#include <residyn.h>

#include <errno.h>
#include <math.h>
#include <sched.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <linux/seccomp.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/utsname.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

/* glibc's own, behind the ones below. */
extern void *__libc_malloc(size_t);
extern void *__libc_calloc(size_t, size_t);
extern void *__libc_realloc(void *, size_t);
extern void *__libc_memalign(size_t, size_t);

static volatile long allocations;

void *malloc(size_t size) {
    ++allocations;
    return __libc_malloc(size);
}

void *calloc(size_t count, size_t size) {
    ++allocations;
    return __libc_calloc(count, size);
}

void *realloc(void *old, size_t size) {
    ++allocations;
    return __libc_realloc(old, size);
}

void *aligned_alloc(size_t alignment, size_t size) {
    ++allocations;
    return __libc_memalign(alignment, size);
}

int posix_memalign(void **out, size_t alignment, size_t size) {
    ++allocations;
    *out = __libc_memalign(alignment, size);
    return *out == NULL ? ENOMEM : 0;
}

enum { MOST = 64, PATH = 4096 };

static double q[PATH][MOST], qd[PATH][MOST], qdd[PATH][MOST];

/* Time by a clock, ns. */
static long long now(clockid_t clock) {
    struct timespec t;
    clock_gettime(clock, &t);
    return t.tv_sec * 1000000000LL + t.tv_nsec;
}

static int ascending(const void *a, const void *b) {
    const float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

/* The loop: `ticks` ticks from tick `from` on; how many returned another code than RESIDYN_OK. */
static long loop(residyn_model *model, double period, size_t n, long from, long ticks) {
    static double tau[MOST];
    uint32_t status = 0;
    long codes = 0;
    for (long k = from; k < from + ticks; ++k) {
        const size_t at = (size_t)(k % PATH);
        codes += residyn_tick(model, (double)k * period, q[at], qd[at], qdd[at], tau, n, &status) != RESIDYN_OK;
    }
    return codes;
}

/* Whether the loop runs to its end where every system call ends the process. */
static int free_of_system_calls(residyn_model *model, double period, size_t n, long from, long ticks) {
    const pid_t child = fork();
    if (child == 0) {
        prctl(PR_SET_SECCOMP, SECCOMP_MODE_STRICT);
        syscall(SYS_exit, loop(model, period, n, from, ticks) == 0 ? 0 : 1);
    }
    int ended = 1;
    return child > 0 && waitpid(child, &ended, 0) == child && WIFEXITED(ended) && WEXITSTATUS(ended) == 0;
}

/* Classes of time by the clock: below 2^i us. */
enum { CLASSES = 16 };

/* Thread CPU time of each of `ticks` ticks from tick `from` on, ns, ascending; the same by the clock is counted in `classes`. */
static long timed(residyn_model *model, double period, size_t n, long from, long ticks, float *times, long classes[CLASSES]) {
    long codes = 0;
    for (long k = 0; k < ticks; ++k) {
        const long long wall = now(CLOCK_MONOTONIC), start = now(CLOCK_THREAD_CPUTIME_ID);
        codes += loop(model, period, n, from + k, 1);
        times[k] = (float)(now(CLOCK_THREAD_CPUTIME_ID) - start);
        const long long lasted = now(CLOCK_MONOTONIC) - wall;
        int class = 0;
        while (class < CLASSES - 1 && lasted >= (1000LL << class)) {
            ++class;
        }
        ++classes[class];
    }
    qsort(times, (size_t)ticks, sizeof *times, ascending);
    return codes;
}

static void print_classes(const long classes[CLASSES]) {
    static const char *const policies[] = {"SCHED_OTHER", "SCHED_FIFO", "SCHED_RR", "SCHED_BATCH"};
    struct utsname system;
    const int policy = sched_getscheduler(0);
    uname(&system);
    printf("by the clock, on %s %s under %s:\n", system.sysname, system.release, policy >= 0 && policy < 4 ? policies[policy] : "another scheduler");
    for (int i = 0; i < CLASSES; ++i) {
        if (classes[i] > 0) {
            printf("  %s %5ld us  %ld\n", i < CLASSES - 1 ? "below" : "above", i < CLASSES - 1 ? 1L << i : 1L << (i - 1), classes[i]);
        }
    }
}

int main(int count, char **given) {
    if (count < 2 || count > 4) {
        fprintf(stderr, "usage: rt_proof MODEL [PERIOD [TICKS]]\n");
        return 2;
    }
    const long ticks = count > 3 ? atol(given[3]) : 1000000;
    residyn_model *model = NULL;
    size_t n = 0;
    double period = 0.0;
    int compensated = 0;
    if (residyn_load(given[1], count > 2 ? atof(given[2]) : 0.0, &model) != RESIDYN_OK || residyn_joints(model, &n) != RESIDYN_OK ||
        residyn_period(model, &period) != RESIDYN_OK || residyn_is_compensated(model, &compensated) != RESIDYN_OK) {
        fprintf(stderr, "error: %s\n", residyn_last_error());
        return 2;
    }
    float *times = malloc((size_t)(ticks > 0 ? ticks : 1) * sizeof *times);
    if (n > MOST || ticks < 1000 || times == NULL) {
        fprintf(stderr, "error: at most %d joints, and at least 1000 ticks\n", MOST);
        return 2;
    }
    /* A closed path: a whole number of turns of every joint. */
    for (size_t k = 0; k < PATH; ++k) {
        for (size_t j = 0; j < n; ++j) {
            const double w = 2.0 * 3.14159265358979323846 * (double)(j % 3 + 1) / (PATH * period);
            const double phase = w * (double)k * period;
            q[k][j] = 0.4 * sin(phase);
            qd[k][j] = 0.4 * w * cos(phase);
            qdd[k][j] = -0.4 * w * w * sin(phase);
        }
    }
    memset(times, 0, (size_t)ticks * sizeof *times);
    const int locked = mlockall(MCL_CURRENT | MCL_FUTURE) == 0;
    struct rusage before, after;
    residyn_start(model);
    /* The first ticks touch what later ones use. */
    long codes = loop(model, period, n, 0, 1000);
    const int quiet = free_of_system_calls(model, period, n, 1000, ticks / 10);
    /* After the fork pages are copied where they are written. */
    codes += loop(model, period, n, 1000, 1000);
    getrusage(RUSAGE_THREAD, &before);
    const long counted = allocations;
    codes += loop(model, period, n, 2000, ticks);
    const long allocated = allocations - counted;
    getrusage(RUSAGE_THREAD, &after);
    const long faults = after.ru_minflt - before.ru_minflt + after.ru_majflt - before.ru_majflt;
    const long waits = after.ru_nvcsw - before.ru_nvcsw;
    long classes[CLASSES] = {0}, faded[CLASSES] = {0};
    codes += timed(model, period, n, 2000 + ticks, ticks, times, classes);
    const double shares[] = {0.5, 0.999, 0.99999, 1.0};
    double at[4];
    for (int i = 0; i < 4; ++i) {
        at[i] = times[(long)(shares[i] * (double)(ticks - 1))] * 1e-3;
    }
    printf("%ld ticks of %zu joints, %s, memory %s\n", ticks, n, compensated ? "physics and compensator" : "physics alone",
           locked ? "locked" : "not locked (mlockall is refused)");
    printf("allocations %ld, page faults %ld, waits %ld, system calls %s, codes other than RESIDYN_OK %ld\n", allocated, faults, waits,
           quiet ? "0" : "some", codes);
    printf("thread CPU time of a tick: median %.1f us, 99.9 %% %.1f us, 99.999 %% %.1f us, largest %.1f us\n", at[0], at[1], at[2], at[3]);
    print_classes(classes);
    /* Arithmetic on numbers below 2^-1022 is many times slower on some processors. */
    for (size_t k = 0; k < PATH; ++k) {
        for (size_t j = 0; j < n; ++j) {
            qd[k][j] *= 1e-310;
            qdd[k][j] *= 1e-310;
            q[k][j] = 0.4 + q[k][j] * 1e-310;
        }
    }
    const long few = ticks / 10;
    codes += loop(model, period, n, 2000 + 2 * ticks, PATH);
    codes += timed(model, period, n, 2000 + 2 * ticks + PATH, few, times, faded);
    printf("at rest, with denormal velocities: median %.1f us, 99.9 %% %.1f us\n", times[few / 2] * 1e-3, times[(long)(0.999 * (double)(few - 1))] * 1e-3);
    free(times);
    residyn_free(model);
    /* Memory that is not locked the kernel may take and give back as it likes. */
    return allocated == 0 && (faults == 0 || !locked) && waits == 0 && quiet && codes == 0 ? 0 : 1;
}
