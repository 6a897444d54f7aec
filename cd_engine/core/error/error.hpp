// How far impulses are from the contact law.
#pragma once

#include "error/residual.hpp"
