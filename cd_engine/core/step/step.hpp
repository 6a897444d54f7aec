// One time step: finds the contacts, solves them, accounts for their forces, moves the bodies.
#pragma once

#include "step/step_tolerance.hpp"
#include "step/time_step.hpp"
