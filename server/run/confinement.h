/// Confinement of a process that solves a run: from its input on, which may be anybody's, it can use
/// memory, threads, clocks and the descriptors that it has, and nothing else of the machine.
///
/// Each layer alone keeps what the others may miss:
///   files, tcp, signals   Landlock (Linux 5.13; tcp since 6.7, signals since 6.12): no path can be opened,
///                         made, changed or executed, no TCP port bound or connected to, no process
///                         outside signalled
///   system_calls          seccomp: what is not on the list of a solver's calls fails with EPERM
///   always                no new privileges by execve(), and no new descriptor (RLIMIT_NOFILE)
///
/// Sanitizers open their own /proc and trace their own process when it ends: in their builds there is only
/// Landlock, and it lets files be read.
///
/// Threads  the process must have one thread: Landlock confines threads, not processes.

#pragma once

#include "core/base/status.h"
#include "server/base/metrics.h"

#include <stdbool.h>

/// The layers that kernel and build have; bit l is that of metrics_layer l. Changes nothing.
unsigned confinement_find(void);

/// Log the layers that solvers of this program will have, as a warning if files or system calls are not
/// among them, and set METRICS_CONFINEMENT.
void confinement_report(void);

/// Give up the superuser for nobody and nogroup, irrevocably. True if the process has no privileges
/// then. Clears the signal of a parent's death (PR_SET_PDEATHSIG).
bool confinement_leave_root(void);

/// Confine this process for the rest of its life by all layers of confinement_find(). BF_ESYSTEM: one of
/// them failed; the process is confined in part, and must not go on.
BF_MUST_CHECK bf_status confinement_enter(bf_error *err);
