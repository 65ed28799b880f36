/// Which solver this program has.

#pragma once

enum { SOLVER_NAME_SIZE = 64 }; ///< bytes of its name with its terminator

/// Write the name of this program's solver, its version and RUN_VERSION, as "0.2.0/10", into SOLVER_NAME_SIZE bytes: results of
/// another name may have other bytes. Returns ret_name.
const char *solver_name(char *ret_name);
