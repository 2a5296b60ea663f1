#pragma once
// A start from rest without sound waves (method-coupling.md, equation 55). Loads on bodies and fluid act at
// once, but the fluid's pressure responds with the speed of sound and oscillates. Here it is there before the
// first step.

namespace silt {

class Scene;

/// Builds up the pressure over quiet_start_steps() of the case: loads act, bodies keep their places, and
/// fluid and bodies are repeatedly brought to rest. Changes nothing but the pressure. Call before the first
/// step, when the flow has started and is driven. Collective.
void start_quietly(Scene&);

}  // namespace silt
