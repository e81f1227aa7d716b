// One number everywhere: clearing knows no unsigned ones.
#version 330 core

uniform uint number;
out uint out_number;

void main() {
    out_number = number;
}
