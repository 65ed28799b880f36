/// The constants of the frame format (frame.h), shared by encoder and decoder.

#pragma once

#if __BYTE_ORDER__ != __ORDER_LITTLE_ENDIAN__
#error "frames and checkpoints are little-endian; this processor needs swaps"
#endif

enum {
    FRAME__MAGIC = 0x31464642, ///< "BFF1"
    FRAME__HEADER_BYTES = 16,  ///< magic, type, length
    FRAME__LENGTH_AT = 8,      ///< of the length in the header
    FRAME__DIGEST_BYTES = 8,   ///< at the end
    FRAME__ALIGNMENT = 8,      ///< of the start and the end of every frame
};
