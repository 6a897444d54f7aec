// The bodies of a scene, their shapes, and where two of them touch.
#pragma once

#include "scene/contact_geometry.hpp"
#include "scene/geometry_in_space.hpp"
#include "scene/hidden_corners.hpp"
#include "scene/hidden_features.hpp"
#include "scene/world.hpp"
