"""bfloat16 where the machine computes in it: elsewhere it is emulated, ten times and more slower than float32."""

from functools import cache

import torch

from physpipe.core.determinism import device


@cache
def has_bfloat16() -> bool:
    """Whether what `device` names has instructions for bfloat16."""
    if device().type == "cuda":
        return torch.cuda.is_bf16_supported(including_emulation=False)
    return any(there for name, there in torch.cpu.get_capabilities().items() if name.endswith("bf16"))


def brief(wanted: bool = True) -> torch.autocast:
    """Context in which networks compute in bfloat16, where that is `wanted` and the machine has it."""
    return torch.autocast(device().type, torch.bfloat16, enabled=wanted and has_bfloat16())
