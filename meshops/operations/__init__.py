"""Operations: one file each; every one returns an Edit and changes nothing."""
