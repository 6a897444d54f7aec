// The bodies of a scene, their shapes, and where two of them touch.
#pragma once

#include "scene/contact_geometry.hpp"
#include "scene/hidden_corners.hpp"
#include "scene/space3.hpp"
#include "scene/world.hpp"
