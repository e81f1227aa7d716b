// Point at an organ anywhere, and it stands out everywhere.
document.addEventListener("pointerover", (event) => {
  const target = event.target.closest("[data-organ]");
  const organ = target ? target.dataset.organ : null;
  document.body.classList.toggle("pointing", organ !== null);
  for (const element of document.querySelectorAll("[data-organ]")) {
    element.classList.toggle("pointed", element.dataset.organ === organ);
  }
});
