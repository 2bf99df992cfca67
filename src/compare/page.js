const viewer = document.querySelector('.viewer');
const slider = viewer.querySelector('input[type=range]');
const split = () => viewer.style.setProperty('--split', `${slider.value}%`);
slider.addEventListener('input', split);
split();

let blinking;
viewer.addEventListener('change', ({ target }) => {
  if (target.name !== 'show') return;
  clearInterval(blinking);
  viewer.dataset.show = target.value === 'blink' ? 'a' : target.value;
  if (target.value !== 'blink') return;
  blinking = setInterval(() => { viewer.dataset.show = viewer.dataset.show === 'a' ? 'b' : 'a'; }, 600);
});
