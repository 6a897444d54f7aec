// One time step: finds the contacts, solves them, accounts for their forces, moves the bodies.
#pragma once

#include "step/time_step.hpp"
