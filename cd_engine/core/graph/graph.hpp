// What the contacts connect: islands, blocks for the threads, groups of contacts that can be solved at once.
#pragma once

#include "graph/blocks.hpp"
#include "graph/grouping.hpp"
#include "graph/partition.hpp"
