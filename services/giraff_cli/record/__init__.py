"""`giraff record`: write a recording, or repair one."""
