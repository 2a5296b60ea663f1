#pragma once
// SILT_DEVICE marks functions that also run on a graphics processor.
#if defined(__CUDACC__)
#define SILT_DEVICE __host__ __device__
#else
#define SILT_DEVICE
#endif
