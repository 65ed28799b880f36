/// The machine's cores.

#pragma once

/// How many cores this process may use, at least 1.
unsigned cores_count(void);
