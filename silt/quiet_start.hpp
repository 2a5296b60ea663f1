#pragma once
// A start from rest without sound (method-coupling.md, equation 55). The loads on bodies and fluid act at
// once, while the pressure by which the fluid of this method answers them comes with the speed of sound, and
// swings. Here the pressure is there before the first step.

namespace silt {

class Scene;

/// Collective, once the flow has started and is driven, before the first step. Lets the loads act for
/// quiet_start_steps() of the case, in which bodies keep their places; fluid and bodies are brought to rest
/// again and again. Then the fluid is at rest with the pressure that has come; of all else the state is as
/// before.
void start_quietly(Scene&);

}  // namespace silt
