"""Series of colour and depth images from a camera that stays where it is (Komatsuna)."""
