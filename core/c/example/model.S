/* The model file as it is, at a multiple of 4. */
    .section .rodata.model, "a"
    .balign 4
    .global model_file, model_file_end
model_file:
    .incbin MODEL_FILE
model_file_end:
    .section .note.GNU-stack, "", %progbits
