"""Tests of meshipelago."""
