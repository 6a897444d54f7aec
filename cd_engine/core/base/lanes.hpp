// How many contacts the kernels solve at once, whatever the width of the processor's vectors: results do not depend on the processor.
#pragma once

namespace cd {

constexpr int lanes = 8;

} // namespace cd
