"""What services cost and how soon samples come, beside bare Zenoh in the same run. See docs/performance.md."""
