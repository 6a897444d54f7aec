// Which bodies are so near each other that they may touch, in an order that suits the sweeps.
#pragma once

#include "search/pair_order.hpp"
#include "search/pair_search.hpp"
#include "search/reach.hpp"
#include "search/space_order.hpp"
