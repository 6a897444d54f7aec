// Loops over eight contacts at once, compiled for each instruction set.
#pragma once

#include "kernels/group.hpp"
#include "kernels/group_in_space.hpp"
#include "kernels/group_kernel.hpp"
#include "kernels/group_source.hpp"
