// The contact problem of one step: bodies, contacts, their law, and the same problem as a matrix.
#pragma once

#include "problem/cone_law.hpp"
#include "problem/cone_system.hpp"
#include "problem/contact_system.hpp"
#include "problem/delassus_system.hpp"
#include "problem/law.hpp"
#include "problem/law_in_space.hpp"
#include "problem/law_rolling.hpp"
